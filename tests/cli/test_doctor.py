"""`flatgrasp doctor` finds what is wrong with an installation, and nothing where nothing is."""

from __future__ import annotations

from importlib.metadata import PackageNotFoundError

import pytest

from flatgrasp_cli import __version__, installation, self_test
from flatgrasp_cli.installation import Package, packages
from tests.conftest import Run

WANTED = [
    "numpy>=2.0",
    "click>=99; python_version >= '3.0'",
    "no-such-package>=1",
    "not-here>=1; sys_platform == 'plan9'",
    "pyyaml>=6; extra == 'some'",
    "nor-this>=1; extra == 'some'",
    "no-tool>=1; extra == 'dev'",
]


@pytest.fixture(autouse=True)
def fresh() -> None:
    self_test._plan.cache_clear()


def test_a_whole_installation_is_well(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(installation, "requires", lambda _: ["numpy>=2.0", "absent>=1; extra == 'some'"])
    done = run("doctor")
    assert (done.code, done.err) == (0, "")
    assert done.out.startswith(f"flatgrasp {__version__}, Python 3.")
    assert done.out.count("\n  ok      ") == len(self_test.TRIALS)
    assert "  some: absent missing; pip install 'flatgrasp[some]'\n" in done.out


def test_what_is_missing_or_too_old_is_said(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(installation, "requires", lambda _: WANTED)
    monkeypatch.setattr(self_test, "TRIALS", {})
    done = run("doctor")
    assert done.code == 1
    click, missing = done.err.splitlines()
    assert click.startswith("flatgrasp: click: click>=99 is wanted, ")
    assert missing == (
        "flatgrasp: no-such-package: no-such-package>=1 is wanted, it is missing; pip install 'no-such-package>=1'"
    )


def test_only_what_this_system_and_users_need_is_looked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(installation, "requires", lambda _: WANTED)
    found = {each.name: each for each in packages()}
    assert set(found) == {"numpy", "click", "no-such-package", "pyyaml", "nor-this"}
    assert (found["numpy"].extra, found["pyyaml"].extra) == (None, "some")
    assert [name for name, each in found.items() if not each.sound] == ["click", "no-such-package", "nor-this"]
    assert Package("x", ">=1", None, "2.0rc1").sound


def test_a_tree_that_was_not_installed_is_no_fault(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    def unknown(name: str) -> list[str]:
        raise PackageNotFoundError(name)

    monkeypatch.setattr(installation, "requires", unknown)
    monkeypatch.setattr(self_test, "TRIALS", {})
    done = run("doctor")
    assert (done.code, done.err) == (0, "")
    assert "never installed" in done.out


@pytest.mark.parametrize(("box", "word"), [((0.12, 0.06, 0.03), "taken for"), ((0.12, 0.06, 0.001), "no grasp")])
def test_a_wrong_answer_fails(
    box: tuple[float, float, float], word: str, run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    points = self_test._points
    expected = self_test.BOX_M

    def others() -> object:
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(self_test, "BOX_M", box)
            return points()

    monkeypatch.setattr(self_test, "_points", others)
    done = run("doctor")
    assert (done.code, self_test.BOX_M) == (1, expected)
    assert word in done.err


def test_a_library_that_does_not_load_is_a_line(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken() -> object:
        raise ImportError("libGL.so.1: cannot open shared object file")

    monkeypatch.setattr(self_test, "load_open3d", broken)
    done = run("doctor")
    assert done.code == 1
    assert done.err == ("flatgrasp: self-test: Open3D loads: ImportError: libGL.so.1: cannot open shared object file\n")
