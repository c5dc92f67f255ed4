"""Pictures and films show what there was, where it was."""

from __future__ import annotations

import dataclasses
import io

import cv2
import numpy as np
import pytest
from PIL import Image

from flatgrasp_cli import load_gripper, load_robot, load_settings
from flatgrasp_cli.job import Job
from flatgrasp_cli.placing import workcell
from flatgrasp_cli.simulation import pictures as drawing
from flatgrasp_cli.simulation.parts import Kind
from flatgrasp_cli.simulation.pictures import FILM_PX, film, trial_figure
from flatgrasp_cli.simulation.rendering import COLORS, eye_on, picture
from flatgrasp_cli.simulation.snapshots import FRAME_S, Recorder, placed
from flatgrasp_cli.simulation.solids import box, capsule, volume
from flatgrasp_cli.simulation.things import sample_thing
from flatgrasp_cli.simulation.trial import TABLE, Cell, Conditions, Trial
from flatgrasp_cli.simulation.trials import trials_of
from tests.conftest import Run


@pytest.fixture(scope="module")
def filmed() -> Trial:
    where = Cell(
        Job(load_gripper("lacquey"), load_settings(), workcell(load_robot("ur5"), None, None)),
        Conditions(friction=0.5, force_n=40.0, tilt_deg=20.0),
    )
    where.recorder = Recorder()
    (trial,) = trials_of(where, sample_thing("hammer"), 1)
    assert trial.status == "held"
    return trial


def colored(image: np.ndarray, kind: Kind) -> np.ndarray:
    """Which pixels have the hue of a kind: the ratios of its colours, however dark."""
    want = np.array(COLORS[kind]) / np.linalg.norm(COLORS[kind])
    length = np.linalg.norm(image.astype(float), axis=-1)
    return np.asarray((image.astype(float) @ want) > 0.9995 * np.maximum(length, 1.0))


def test_a_block_in_a_picture_is_where_it_is_and_throws_a_shadow() -> None:
    block = box((0.1, 0.1, 0.1), (0.0, 0.0, 0.3)).surface
    eye = eye_on(np.zeros(3), 0.6, 0.0, np.radians(89))
    image = picture([block, TABLE], [Kind.THING, Kind.TABLE], eye, (160, 160))
    rows, columns = np.nonzero(colored(image, Kind.THING))
    assert (rows.mean(), columns.mean()) == (pytest.approx(79.5, abs=2), pytest.approx(79.5, abs=1))
    on_table = colored(image, Kind.TABLE)
    bright = image[..., 1][on_table]
    shadow = np.argwhere(on_table & (image[..., 1] < 0.9 * np.median(bright)))
    assert len(shadow) > 100
    # away from the light, which comes from +x and −y: the eye looks down from +x, so that x is down and y to the right
    assert (shadow.mean(axis=0) - 79.5)[0] < -5
    assert (shadow.mean(axis=0) - 79.5)[1] > 5


def test_nothing_in_view_is_white() -> None:
    image = picture(
        [box((0.1, 0.1, 0.1), (0, 0, -5)).surface], [Kind.THING], eye_on(np.zeros(3), 0.2, 1.0, 0.3), (20, 10)
    )
    assert image.shape == (10, 20, 3)
    assert (image == 255).all()


def test_a_capsule_has_its_volume() -> None:
    expected = np.pi * 0.02**2 * 0.1 + 4 / 3 * np.pi * 0.02**3
    assert volume(capsule(0.02, 0.1).surface) == pytest.approx(expected, rel=0.01)


def test_a_film_follows_the_hand_and_what_it_holds(filmed: Trial) -> None:
    assert filmed.film is not None
    shapes, moments = filmed.film.shapes, filmed.film.snapshots
    assert 3 / FRAME_S < len(moments) < 10 / FRAME_S
    kinds = [shape.kind for shape in shapes]
    assert {*kinds} == {Kind.TABLE, Kind.THING, Kind.FINGER, Kind.PALM, Kind.ARM, Kind.CAMERA}
    assert kinds.count(Kind.FINGER) == 6  # two phalanges of three fingers
    first, last = (placed(shapes, moment) for moment in (moments[0], moments[-1]))
    thing, table, palm = (kinds.index(kind) for kind in (Kind.THING, Kind.TABLE, Kind.PALM))
    rise = last[thing].vertices[:, 2].mean() - first[thing].vertices[:, 2].mean()
    assert rise == pytest.approx(0.1, abs=0.02)
    assert (last[table].vertices == first[table].vertices).all()
    apart = np.linalg.norm(last[palm].vertices.mean(axis=0) - last[thing].vertices.mean(axis=0))
    assert apart < 0.25 < np.linalg.norm(first[palm].vertices.mean(axis=0) - first[thing].vertices.mean(axis=0))


def test_the_camera_is_drawn_where_it_looks_from(filmed: Trial) -> None:
    assert filmed.film is not None
    meshes = placed(filmed.film.shapes, filmed.film.snapshots[0])
    housing = meshes[[shape.kind for shape in filmed.film.shapes].index(Kind.CAMERA)]
    nearest = np.linalg.norm(housing.vertices - filmed.camera.position, axis=1).min()
    assert nearest == pytest.approx(np.hypot(0.035, 0.18) / 2, abs=1e-3)  # the middle of its face


def test_the_picture_has_the_six_columns_of_figure_18(filmed: Trial) -> None:
    assert filmed.film is not None
    figure = trial_figure(filmed, filmed.film)
    titles = [axes.get_title(loc="left") for axes in figure.axes]
    assert titles == [
        *("set-up", "bounding box", "candidates and directions"),
        *("final grasp", "grasp area on the cloud", "execution"),
    ]
    names = {text.get_text() for text in figure.legends[0].get_texts()}
    assert {"oriented box", "finger candidates", "grasping directions", "final grasp", "under the pads"} <= names
    fingers = filmed.plan.objects[0].trace.fingers
    assert fingers is not None
    assert len(figure.axes[2].collections[0].get_paths()) == len(fingers)
    chosen = figure.axes[3].collections[0].get_paths()
    assert len(chosen) == 2


def test_without_an_object_the_picture_says_why(filmed: Trial) -> None:

    plan = dataclasses.replace(filmed.plan, objects=())
    nothing = dataclasses.replace(filmed, plan=plan, execution=None, tips=None)
    assert filmed.film is not None
    figure = trial_figure(nothing, filmed.film)
    assert sum(axes.axison for axes in figure.axes) == 0
    assert "hammer: no grasp" in figure.get_suptitle()


def test_the_command_draws_and_films(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    small = (FILM_PX[0] // 4, FILM_PX[1] // 4)
    monkeypatch.setattr(drawing, "FILM_PX", small)
    options = ("-g", "robotiq_2f_85", "--robot", "none", "--trials", "1", "--plots", "--film", "it.gif", "-o", "out")
    done = run("simulate", "juice_box", *options)
    assert done.code == 0
    assert "wrote out/juice_box.00.trial.png, it.gif" in done.err
    drawn = cv2.imread("out/juice_box.00.trial.png")
    assert drawn is not None
    assert drawn.shape[1] == 1200
    with Image.open("it.gif") as pictures:
        assert (pictures.size, pictures.n_frames > 30) == (small, True)  # type: ignore[attr-defined]
    refused = run("simulate", "juice_box", "--film", "it.mp4")
    assert (refused.code, "it.mp4: a film is a GIF; give FILE.gif" in refused.err) == (2, True)


def test_a_film_of_several_trials_is_one_after_the_other(filmed: Trial) -> None:
    assert filmed.film is not None

    short = dataclasses.replace(filmed, film=dataclasses.replace(filmed.film, snapshots=filmed.film.snapshots[::20]))
    assert short.film is not None
    with Image.open(io.BytesIO(film([short, short]))) as pictures:
        assert pictures.n_frames <= 2 * len(short.film.snapshots)  # type: ignore[attr-defined]
        assert pictures.info["duration"] >= round(1000 * FRAME_S)
