"""Which number could be wrong without a test that notices? Changes them one at a time and runs the tests.

    nice python benchmarks/constants.py [planner scene surroundings ranking settings] [NAME ...] [--factor 1.5]

Every numeric constant of these rooms' modules and every number of configs/planner/default.yaml is multiplied and
divided by 1.5, one at a time (of a tuple, one member at a time; an array as a whole). With that the room's tests run in
a process forked for it, until one fails. What passes is printed, and the share that does not. All of them take an hour:
name rooms, or constants (`LIMB_M`, `seam_deg`), to try those alone; `--factor 3` finds what could be grossly wrong.
"""

from __future__ import annotations

import argparse
import ast
import importlib
import math
import os
import pkgutil
import signal
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from types import ModuleType
from typing import Any

from flatgrasp_cli.threads import one_thread_each

one_thread_each()
import numpy as np
import pytest
import scipy.spatial.transform  # noqa: F401 (paid once, like all imports here)
import shapely  # noqa: F401

import flatgrasp_cli
from flatgrasp_cli.errors import ProfileError
from flatgrasp_cli.profiles import load_settings, loading

ROOT = Path(__file__).resolve().parent.parent
ROOMS = ("planner", "scene", "surroundings", "ranking")
SETTINGS = "settings"
ON_A_TABLE = ("surroundings/test_depth", "surroundings/test_opening", "surroundings/test_hidden_sides")
TESTS = {
    "planner": ("planner/test_silhouette", "planner", "planning/test_analytic", *ON_A_TABLE),
    "scene": ("scene", *ON_A_TABLE),
    "surroundings": ("surroundings",),
    "ranking": ("ranking", "planning/test_analytic", *ON_A_TABLE),
    SETTINGS: ("ranking", "planner", "surroundings", "scene", "proof/test_caging_settings", "planning/test_analytic"),
}
"""The files and folders of tests that could notice, the quickest first."""
TIMES_AS_LONG = 3
"""A change that makes the tests run so many times as long as they do without one is noticed, too."""
NO_QUANTITY = {"EITHER_JAW", "PRIMES", "seed"}
"""A name, and numbers that any others would do for."""
PASSED, FAILED, REFUSED = 0, 1, 2


@dataclass(frozen=True)
class Number:
    """A number of a room: where it is, its dotted or indexed name, and its value: an int, a float or an array."""

    room: str
    module: str
    name: str
    value: Any
    path: tuple[int, ...] = ()

    def __str__(self) -> str:
        place = "".join(f"[{index}]" for index in self.path)
        return f"{self.module.removeprefix('flatgrasp_cli.')}.{self.name}{place}"

    def changed(self, factor: float) -> tuple[Any, Any]:
        """So many times as much, and as little; of whole numbers at least one more and one less."""
        if isinstance(self.value, int):
            more, less = round(factor * self.value), round(self.value / factor)
            return max(more, self.value + 1), min(less, self.value - 1)
        return self.value * factor, self.value / factor


def constants(room: str) -> Iterator[Number]:
    """The numbers that the modules of a room are written with."""
    for info in pkgutil.walk_packages([str(ROOT / "flatgrasp_cli" / room)], f"flatgrasp_cli.{room}."):
        module = importlib.import_module(info.name)
        for statement in ast.parse(Path(str(module.__file__)).read_text("utf-8")).body:
            targets = statement.targets if isinstance(statement, ast.Assign) else []
            names = [node.id for target in targets for node in ast.walk(target) if isinstance(node, ast.Name)]
            for name in filter(str.isupper, names):
                yield from _numbers(Number(room, info.name, name, getattr(module, name)))


def _numbers(number: Number) -> Iterator[Number]:
    """The number itself, those of a tuple, or nothing where it is a text."""
    if isinstance(number.value, tuple):
        for index, value in enumerate(number.value):
            yield from _numbers(Number(number.room, number.module, number.name, value, (*number.path, index)))
    elif isinstance(number.value, int | float | np.ndarray):
        yield number


def settings_numbers() -> Iterator[Number]:
    """The numbers of the default settings."""
    for section, values in loading.read_yaml(loading.profile_path("planner", "default")).items():
        for key, value in values.items() if isinstance(values, dict) else ((section, values),):
            if isinstance(value, int | float) and not isinstance(value, bool):
                yield Number(SETTINGS, section, key, value)


def replaced(old: Any, path: tuple[int, ...], new: Any) -> Any:
    """`old`, or the tuple that it is with `new` at the indices `path`."""
    if not path:
        return new
    return (*old[: path[0]], replaced(old[path[0]], path[1:], new), *old[path[0] + 1 :])


def change(number: Number, value: Any) -> None:
    """Give the number another value, wherever it was imported to."""
    if number.room == SETTINGS:
        loading.read_yaml = partial(_changed_yaml, loading.read_yaml, number, value)
        return
    old = getattr(sys.modules[number.module], number.name)
    new = replaced(old, number.path, value)
    for module in _modules():
        if getattr(module, number.name, None) is old:
            setattr(module, number.name, new)


def _changed_yaml(read: Any, number: Number, value: Any, path: Path, kind: str = "profile") -> dict[str, Any]:
    data: dict[str, Any] = read(path, kind)
    if path == loading.profile_path("planner", "default"):
        (data if number.module == number.name else data[number.module])[number.name] = value
    return data


def _modules() -> list[ModuleType]:
    return [module for name, module in sys.modules.items() if name.startswith("flatgrasp_cli.")]


def end_of(room: str, seconds: int = 0, number: Number | None = None, value: Any = None) -> int:
    """How a room's tests end in a process of their own, in which the number has another value.

    FAILED if they don't end within some seconds, where any are given.
    """
    child = os.fork()
    if child == 0:
        signal.alarm(seconds)
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, 1)
        os.dup2(nowhere, 2)
        if number is not None:
            change(number, value)
        try:
            load_settings()
        except ProfileError:
            os._exit(REFUSED)
        places = [ROOT / "tests" / name for name in TESTS[room]]
        tests = [str(place if place.is_dir() else place.with_suffix(".py")) for place in places]
        os._exit(FAILED if pytest.main(["-x", "-q", "-p", "no:cacheprovider", *tests]) else PASSED)
    _, status = os.waitpid(child, 0)
    return os.waitstatus_to_exitcode(status) if os.WIFEXITED(status) else FAILED


def main() -> None:
    """Try the numbers and print those whose change no test notices."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", help="rooms or constants (default: all)")
    parser.add_argument("--factor", type=float, default=1.5, help="by which a number is multiplied, and divided")
    options = parser.parse_args()
    wanted = set(options.names)
    for info in pkgutil.walk_packages(flatgrasp_cli.__path__, "flatgrasp_cli."):
        if not info.name.endswith("__main__"):
            importlib.import_module(info.name)
    found = [*(number for room in ROOMS for number in constants(room)), *settings_numbers()]
    chosen = [number for number in found if not wanted or {number.room, number.name} & wanted]
    chosen = [number for number in chosen if number.name not in NO_QUANTITY]
    longest = {}
    for room in sorted({number.room for number in chosen}):
        began = time.monotonic()
        if end_of(room) != PASSED:
            parser.error(f"the tests of {room} fail without any change")
        longest[room] = math.ceil(TIMES_AS_LONG * (time.monotonic() - began))
    lived = 0
    for number in chosen:
        end = partial(end_of, number.room, longest[number.room], number)
        passed = [value for value in number.changed(options.factor) if end(value) == PASSED]
        lived += len(passed)
        for value in passed:
            print(f"{number} = {number.value}: {value} passes", flush=True)
    changes = 2 * len(chosen)
    print(f"{len(chosen)} numbers; tests notice {changes - lived} of {changes} changes")


if __name__ == "__main__":
    main()
