"""The page in three dimensions: what is in it, what is not, and what a browser makes of it."""

from __future__ import annotations

import base64
import hashlib
import json
import re
import sys
import webbrowser
import zlib
from collections.abc import Iterator
from functools import cache
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from flatgrasp_cli import load_gripper, load_robot, plan
from flatgrasp_cli.errors import UsageError
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.model import Cloud, Source
from flatgrasp_cli.results.document import to_document, to_json
from flatgrasp_cli.results.page import Frame, library, page
from flatgrasp_cli.results.page.library import three_js
from flatgrasp_cli.results.page.packing import MOST_POINTS, packed
from flatgrasp_cli.results.saved import SavedDocument
from tests.conftest import SAMPLES, TABLE, Box, Camera, Run, planned_sample
from tests.plates import slab, write_pcd
from tests.results.browser import CHROMIUM, Browser, browser

HOSTILE = '</script></title><img src=x onerror="hacked=1"><script>hacked=1</script><!--\u2028\'&amp;'
REAL = Path(__file__).resolve().parents[3] / "shared" / "data" / "recordings" / "pct_three_clouds.mcap"
LARGEST_BYTES = 3_000_000
INTERACTIVE_MS = 3000


def document_of(name: str = "table_scene", gripper: str = "robotiq_2f_85") -> dict[str, Any]:
    return to_document(planned_sample(name, gripper))


def saved(values: dict[str, Any]) -> SavedDocument:
    return SavedDocument.model_validate_json(to_json(values))


@cache
def scene_page() -> str:
    """That of the table's scene."""
    made_of = planned_sample("table_scene", "robotiq_2f_85")
    return "".join(page([Frame(saved(document_of()), made_of.cloud)], "flatgrasp: table"))


def hostile_page() -> str:
    """One in which every name that is not ours is hostile."""
    values = document_of()
    source = values["source"] | {"path": HOSTILE, "topic": HOSTILE}
    objects = [item | {"reason": HOSTILE, "remedy": HOSTILE} for item in values["objects"]]
    values |= {"source": source, "frame_id": HOSTILE, "objects": objects, "reason": HOSTILE}
    values |= {"gripper": values["gripper"] | {"name": HOSTILE}, "warnings": [{"code": "x", "text": HOSTILE}]}
    return "".join(page([Frame(saved(values), None)], HOSTILE))


class Parsed(HTMLParser):
    """The elements of a page, as a browser parses them, and the text of each script and of the title."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.texts: list[str] = []
        self._open = False
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))
        self.texts.append("")
        self._open = True

    def handle_endtag(self, tag: str) -> None:  # noqa: ARG002
        self._open = False

    def handle_data(self, data: str) -> None:
        if self._open:
            self.texts[-1] += data

    def of(self, tag: str) -> list[tuple[dict[str, str | None], str]]:
        """Attributes and text of each element of a kind."""
        found = zip(self.tags, self.texts, strict=True)
        return [(attributes, text) for (name, attributes), text in found if name == tag]

    @property
    def scenes(self) -> list[Any]:
        """The data of the page."""
        (text,) = (text for attributes, text in self.of("script") if attributes.get("id") == "scenes")
        return list(json.loads(text))


def test_the_page_asks_for_nothing_from_outside() -> None:
    parsed = Parsed(scene_page())
    assert not [tag for tag, attributes in parsed.tags if {"src", "href", "srcset", "data"} & set(attributes)]
    assert {tag for tag, _ in parsed.tags}.isdisjoint({"link", "iframe", "object", "embed", "img", "base"})
    policy = next(attributes["content"] for attributes, _ in parsed.of("meta") if "http-equiv" in attributes) or ""
    assert policy.startswith("default-src 'none'; script-src 'sha256-")
    scripts = [text for attributes, text in parsed.of("script") if not attributes.get("type")]
    hashes = {base64.b64encode(hashlib.sha256(text.encode()).digest()).decode() for text in scripts}
    assert set(re.findall(r"sha256-([^']+)", policy)) == hashes
    assert len(hashes) == 2


def test_hostile_names_are_data_and_never_markup() -> None:
    harmless = "".join(page([Frame(saved(document_of()), None)], "x"))
    parsed, plain = Parsed(hostile_page()), Parsed(harmless)
    assert [tag for tag, _ in parsed.tags] == [tag for tag, _ in plain.tags]
    assert HOSTILE not in hostile_page()
    (scene,) = parsed.scenes
    assert [scene[key] for key in ("name", "topic", "frame_id")] == [HOSTILE] * 3
    assert scene["warnings"] == [HOSTILE]
    assert parsed.of("title")[0][1] == HOSTILE


def test_the_own_script_sets_no_markup_and_asks_for_nothing() -> None:
    folder = Path(library.__file__).parent / "script"
    files = sorted(folder.glob("*.js"))
    assert len(files) > 3
    for file in files:
        text = file.read_text(encoding="utf-8")
        assert not re.search(
            r"innerHTML|outerHTML|insertAdjacent|document\.write|eval\(|Function\(|fetch\(|https?:", text
        )
        assert len(text.splitlines()) <= 250


def unpacked(values: Any) -> tuple[FloatArray, Any]:
    """The points and colours of a packed cloud, the way the page's script gets at them."""
    data = np.frombuffer(zlib.decompress(base64.b64decode(values.data)), dtype=np.uint8)
    raw = data.reshape(9 if values.colored else 6, values.count)
    zigzag = raw[:3].astype(int) | raw[3:6].astype(int) << 8
    steps = np.cumsum((zigzag >> 1) ^ -(zigzag & 1), axis=1) & 0xFFFF
    points = np.array(values.low) + values.step * steps.T
    return points, np.cumsum(raw[6:].astype(int), axis=1).T & 0xFF


def test_a_packed_cloud_is_the_cloud_to_half_a_step() -> None:
    rng = np.random.default_rng(1)
    points = rng.uniform([-1, 0, 2], [1, 0.5, 3], (5000, 3))
    colors = rng.integers(0, 256, (5000, 3), dtype=np.uint8)
    values = packed(points, colors)
    back, shades = unpacked(values)
    assert values.step == pytest.approx(2 / 65535, rel=1e-3)
    order = np.lexsort(np.round(back - values.low, 9).T)
    again = np.lexsort((np.round((points - values.low) / values.step) * values.step).round(9).T)
    assert np.abs(back[order] - points[again]).max() <= values.step / 2 + 1e-9
    assert np.array_equal(shades[order], colors[again])


@pytest.mark.parametrize("count", [0, 1])
def test_clouds_of_no_point_or_one_are_packed(count: int) -> None:
    values = packed(np.full((count, 3), 0.5), None)
    assert values.count == count
    assert unpacked(values)[0].tolist() == [[0.5, 0.5, 0.5]] * count


@cache
def large() -> tuple[SavedDocument, Cloud]:
    """A colourful frame of 300,000 points, shuffled: a box and what else a camera of that many pixels sees."""
    camera = Camera(tilt_deg=20.0, pixels=(760, 580), focal=900.0)
    box, other = Box((0.0, 0.0, 0.03), (0.05, 0.16, 0.06), 20.0), Box((0.15, 0.05, 0.02), (0.04, 0.1, 0.04), -40.0)
    seen = camera.sees(TABLE, box, other)
    rng = np.random.default_rng(0)
    points = rng.permutation(seen.points)[:MOST_POINTS]
    assert len(points) == MOST_POINTS
    colors = np.clip(rng.normal(128 + 400 * points, 8.0), 0, 255).astype(np.uint8)
    cloud = Cloud(points, seen.viewpoint, Source("large.pcd"), colors=colors)
    found = plan(cloud, load_gripper("robotiq_2f_85"))
    assert found.best is not None
    return saved(to_document(found)), found.cloud


def test_a_frame_of_300000_points_takes_three_megabytes_at_most() -> None:
    text = "".join(page([Frame(*large())], "large"))
    assert len(text.encode()) - len(three_js().encode()) <= LARGEST_BYTES
    assert len(three_js().encode()) < 700_000


def test_several_frames_are_thinned() -> None:
    document, cloud = large()
    text = "".join(page([Frame(document, cloud)] * 2, "large"))
    scenes = Parsed(text).scenes
    assert len(scenes) == 2
    assert scenes[0]["cloud"]["count"] == len({tuple(cube) for cube in np.floor(cloud.points / 3e-3).tolist()})
    assert scenes[0]["cloud"]["colored"]


def test_a_page_tells_what_the_document_tells() -> None:
    values = document_of()
    first = values["objects"][0]["grasps"][0]
    first["success"] = {
        "probability": 0.93,
        "clear": 1.0,
        "causes": {"too_heavy": 0.02, "slips": 0.048, "turns": 0.002},
    }
    values["objects"][-1] |= {"grasps": [], "status": "no_grasp", "reason": "no room", "remedy": "another hand"}
    (scene,) = Parsed("".join(page([Frame(saved(values), None)], "x"))).scenes
    shown = scene["objects"][0]["grasps"][0]
    assert shown["holds"] == "93 %"
    assert shown["causes"] == [["slips", "5 %"], ["too heavy", "2 %"]]
    distance = f"{1e3 * first['metrics']['gravity_distance_m']:.3g} mm"
    assert ["gravity distance", distance] in shown["rows"]
    assert shown["poses"]["lift"] == first["lift"]
    assert len(shown["open"]) == len(shown["closed"]) == 3
    assert scene["objects"][-1]["why"] == ["no room", "another hand"]
    assert scene["objects"][-1]["stages"]
    assert scene["cloud"] is None


def test_the_arm_ends_where_the_hand_begins() -> None:
    camera = Camera(tilt_deg=0.0)
    seen = camera.sees(Box((0.0, 0.0, 0.03), (0.05, 0.16, 0.06)), TABLE)
    away = np.array([0.5, 0.0, 0.0])
    moved = Cloud(seen.points + away, camera.frame.origin + away, Source("test"), frame_id="base")
    gripper = load_gripper("robotiq_2f_85")
    document = to_document(plan(moved, gripper, robot=load_robot("ur5e")))
    (scene,) = Parsed("".join(page([Frame(saved(document), moved)], "x"))).scenes
    grasp = document["objects"][0]["grasps"][0]
    for phase in ("pre_grasp", "lift"):
        assert scene["objects"][0]["grasps"][0]["arm"][phase][-1] == pytest.approx(
            grasp["flange"][phase]["position"], abs=1e-3
        )


def test_without_the_library_the_error_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(library, "PLACE", ("nowhere.zip",))
    three_js.cache_clear()
    with pytest.raises(UsageError, match="pip install 'trimesh"):
        three_js()


# --- the command ------------------------------------------------------------------------------------------------------


def scenes_of(path: Path | str) -> list[Any]:
    return Parsed(Path(path).read_text(encoding="utf-8")).scenes


def test_view_shows_a_source_and_its_document_alike(run: Run) -> None:
    done = run("view", SAMPLES / "pan_ros2", "-g", "pr2")
    assert (done.code, done.out, done.err) == (0, "", "flatgrasp: wrote pan_ros2.html\n")
    Path("pan.jsonl").write_text(run("plan", SAMPLES / "pan_ros2", "-g", "pr2", "--json").out, encoding="utf-8")
    assert run("view", "pan.jsonl", "--out", "again.html").code == 0
    assert scenes_of("again.html") == scenes_of("pan_ros2.html")
    assert [scene["cloud"]["count"] > 1000 for scene in scenes_of("again.html")] == [True] * 3


def test_view_finds_the_cloud_in_the_frame_of_the_document(run: Run) -> None:
    planned = run("plan", SAMPLES / "pan_ros2", "--json", "--base-frame", "base_link", "--at", "0.2")
    Path("pan.json").write_text(planned.out, encoding="utf-8")
    assert run("view", "pan.json").err == "flatgrasp: wrote pan.html\n"
    (scene,) = scenes_of("pan.html")
    assert scene["cloud"] is not None
    assert scene["frame_id"] == "base_link"


@pytest.mark.parametrize("change", ["gone", "scaled", "other"])
def test_view_says_when_the_cloud_is_not_the_one(change: str, run: Run) -> None:
    Path("pan.pcd").write_bytes((SAMPLES / "pan.pcd").read_bytes())
    assert run("plan", "pan.pcd", "--plots", "none", "-g", "pr2").code == 0
    if change == "gone":
        Path("pan.pcd").unlink()
    if change == "other":
        Path("pan.pcd").write_bytes((SAMPLES / "hammer.pcd").read_bytes())
    done = run("view", "pan.grasps.json", *(("--scale", "0.001") if change == "scaled" else ()))
    assert done.code == 0
    assert done.err.count("warning: ") == 1
    assert "the page has no cloud" in done.err
    (scene,) = scenes_of("pan.html")
    assert scene["cloud"] is None
    assert scene["objects"][0]["grasps"]


def test_view_finds_each_cloud_whatever_the_order_of_the_documents(run: Run) -> None:
    lines = run("plan", SAMPLES / "pan_ros2", "--json", "-g", "pr2").out.splitlines()
    Path("turned.jsonl").write_text("\n".join(reversed(lines)), encoding="utf-8")
    assert run("view", "turned.jsonl").err == "flatgrasp: wrote turned.html\n"
    scenes = scenes_of("turned.html")
    assert [scene["name"] for scene in scenes] == sorted((scene["name"] for scene in scenes), reverse=True)
    assert all(scene["cloud"] for scene in scenes)


@pytest.mark.skipif(not REAL.exists(), reason="needs the shared recordings")
def test_view_finds_clouds_whose_own_clock_is_not_the_recordings(run: Run) -> None:
    Path("real.jsonl").write_text(run("plan", REAL, "--json", "-g", "pr2", "--approach", "top").out, encoding="utf-8")
    assert "warning" not in run("view", "real.jsonl").err
    assert all(scene["cloud"] for scene in scenes_of("real.html"))


def test_view_looks_for_the_source_beside_the_document(run: Run, tmp_path: Path) -> None:
    Path("pan.pcd").write_bytes((SAMPLES / "pan.pcd").read_bytes())
    assert run("plan", "pan.pcd", "--plots", "none", "-g", "pr2").code == 0
    (tmp_path / "moved").mkdir()
    for name in ("pan.pcd", "pan.grasps.json"):
        Path(name).rename(tmp_path / "moved" / name)
    assert "warning" not in run("view", tmp_path / "moved" / "pan.grasps.json").err
    assert scenes_of("pan.html")[0]["cloud"] is not None


def test_view_refuses_to_plan_a_document_otherwise(run: Run) -> None:
    Path("x.json").write_text("{}", encoding="utf-8")
    done = run("view", "x.json", "--gripper", "pr2")
    assert (done.code, "--gripper cannot change a document" in done.err) == (2, True)
    assert run("view", "x.json").code == 3
    assert list(Path().glob("*.html")) == []


def test_view_says_by_its_exit_code_that_there_is_no_grasp(run: Run, tmp_path: Path) -> None:
    plate = write_pcd(tmp_path / "large.pcd", slab(300, 300, points=2000))
    assert run("view", plate).code == 1
    (scene,) = scenes_of("large.html")
    assert scene["objects"][0]["why"]


def test_view_opens_a_browser_only_where_somebody_sees_it(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    opened: list[str] = []
    monkeypatch.setattr(webbrowser, "open", opened.append)
    call = ("view", SAMPLES / "pan.pcd", "-g", "pr2")
    monkeypatch.setenv("DISPLAY", ":0")
    assert run(*call).code == 0
    assert opened == []  # nobody sits at the terminal
    monkeypatch.setattr("sys.stderr.isatty", lambda: True, raising=False)
    assert run(*call, "--out", "asked.html").code == 0
    assert opened == []
    assert run(*call).code == 0
    assert opened == [Path("pan.html").resolve().as_uri()]
    if sys.platform == "linux":
        monkeypatch.delenv("DISPLAY")
        monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
        assert run(*call).code == 0
        assert len(opened) == 1


@pytest.mark.usefixtures("blank_pictures")
def test_a_batchs_report_links_to_pages(run: Run) -> None:
    assert run("batch", SAMPLES / "pan_ros2", "-o", "out", "-j", "1", "-g", "pr2", "--plots", "-q").code == 0
    report = Parsed(Path("out/report.html").read_text(encoding="utf-8"))
    links = [attributes["href"] for attributes, _ in report.of("a")]
    assert "./pan_ros2.view.html" in links
    assert len(scenes_of("out/pan_ros2.view.html")) == 3


# --- in a browser -----------------------------------------------------------------------------------------------------

in_a_browser = pytest.mark.skipif(CHROMIUM is None, reason="needs Chromium")


@pytest.fixture(scope="module")
def tab(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    with browser(tmp_path_factory.mktemp("profile")) as opened:
        yield opened


def opened(tab: Browser, path: Path, text: str) -> None:
    path.write_text(text, encoding="utf-8")
    tab.open(path)
    tab.wait("document.body.dataset.drawn")


def pressed(tab: Browser) -> list[str]:
    """What is chosen in the list."""
    found = "[...document.querySelectorAll('button.grasp[aria-pressed=true]')].map(b => b.textContent)"
    return list(tab.run(found))


@in_a_browser
def test_clicking_a_grasp_selects_it(tab: Browser, tmp_path: Path) -> None:
    opened(tab, tmp_path / "page.html", scene_page())
    first = pressed(tab)
    assert len(first) == 1
    tab.click_on("button.grasp:nth-of-type(3)")
    (third,) = pressed(tab)
    assert third.startswith("#3")
    assert tab.run("document.querySelector('button.grasp:nth-of-type(3) + table').rows.length") > 5
    tab.key("ArrowUp")
    assert pressed(tab)[0].startswith("#2")
    tab.key("3")
    assert tab.run("document.querySelector('[data-phase=lift]').ariaPressed") == "true"
    assert tab.requested() == [(tmp_path / "page.html").as_uri()]
    assert tab.said() == []


@in_a_browser
def test_clicking_a_closing_line_in_the_scene_selects_its_grasp(tab: Browser, tmp_path: Path) -> None:
    opened(tab, tmp_path / "page.html", scene_page())
    before, found = pressed(tab), set[str]()
    width, height = tab.run("[view.clientWidth, view.clientHeight]")
    for x in np.linspace(0.2, 0.7, 12) * width:
        for y in np.linspace(0.3, 0.7, 8) * height:
            tab.click(float(x), float(y))
        found |= set(pressed(tab))
    assert len(found | set(before)) > 1
    assert tab.said() == []


@in_a_browser
def test_the_scene_is_drawn_and_turned_by_the_mouse(tab: Browser, tmp_path: Path) -> None:
    import cv2

    def picture() -> Any:
        drawn = tab.run("document.body.dataset.drawn")
        tab.key("c")
        tab.key("c")
        tab.wait(f"document.body.dataset.drawn !== '{drawn}'")
        seen = cv2.imdecode(np.frombuffer(tab.picture(), np.uint8), cv2.IMREAD_COLOR)
        assert seen is not None
        return seen[100:500, 100:700].astype(int)

    opened(tab, tmp_path / "page.html", scene_page())
    one = picture()
    assert len(np.unique(one.reshape(-1, 3), axis=0)) > 100
    for kind, x in (("mousePressed", 300), ("mouseMoved", 420), ("mouseReleased", 420)):
        tab.call("Input.dispatchMouseEvent", type=kind, x=x, y=300, button="left", buttons=1, clickCount=1)
    assert np.abs(picture() - one).mean() > 3


@in_a_browser
def test_the_slider_goes_through_the_frames(tab: Browser, tmp_path: Path) -> None:
    names = ("table_scene", "pan_on_table")
    frames = [Frame(saved(document_of(name)), planned_sample(name, "robotiq_2f_85").cloud) for name in names]
    opened(tab, tmp_path / "page.html", "".join(page(frames, "two")))
    assert tab.run("frame.max") == "1"
    tab.run("frame.value = 1; frame.dispatchEvent(new Event('input'))")
    assert "pan_on_table" in tab.run("document.getElementById('name').textContent")
    assert tab.run("document.getElementById('number').textContent") == "2 of 2"
    tab.run("document.activeElement.blur()")
    tab.key("ArrowLeft")
    assert "table_scene" in tab.run("document.getElementById('name').textContent")
    assert tab.said() == []


@in_a_browser
def test_hostile_names_are_read_and_not_run(tab: Browser, tmp_path: Path) -> None:
    hidden = tmp_path / "<img src=x onerror=hacked=1>.html"
    opened(tab, hidden, hostile_page())
    assert tab.run("document.getElementById('name').textContent") == HOSTILE
    assert tab.run("document.title.includes('onerror')")
    assert tab.run("typeof hacked") == "undefined"
    assert tab.run("document.images.length") == 0
    assert tab.requested() == [hidden.as_uri()]
    tab.run("document.body.insertAdjacentHTML('beforeend', '<img src=x onerror=\"hacked=1\">')")  # even if one got in
    assert tab.run("new Promise(done => setTimeout(() => done(typeof hacked), 200))") == "undefined"


@in_a_browser
def test_a_large_page_works(tab: Browser, tmp_path: Path) -> None:
    opened(tab, tmp_path / "large.html", "".join(page([Frame(*large())], "large")))
    tab.click_on("button.grasp:nth-of-type(2)")
    assert pressed(tab)[0].startswith("#2")


@pytest.mark.slow  # others may be at work on the machine
@in_a_browser
def test_a_large_page_is_interactive_within_three_seconds(tab: Browser, tmp_path: Path) -> None:
    opened(tab, tmp_path / "large.html", "".join(page([Frame(*large())], "large")))
    assert int(tab.run("document.body.dataset.ready")) < INTERACTIVE_MS


@in_a_browser
def test_a_browser_without_webgl_still_shows_the_list(tab: Browser, tmp_path: Path) -> None:
    blocked = tab.call(
        "Page.addScriptToEvaluateOnNewDocument", source="HTMLCanvasElement.prototype.getContext = () => null"
    )
    try:
        (tmp_path / "page.html").write_text(scene_page(), encoding="utf-8")
        tab.open(tmp_path / "page.html")
        assert "WebGL" in tab.run("document.getElementById('help').textContent")
        tab.click_on("button.grasp:nth-of-type(2)")
        assert pressed(tab)[0].startswith("#2")
    finally:
        tab.call("Page.removeScriptToEvaluateOnNewDocument", identifier=blocked["identifier"])
