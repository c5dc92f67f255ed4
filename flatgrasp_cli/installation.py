"""What an installation of the project wants, and what it has; this module loads nothing that could be missing."""

from __future__ import annotations

import re
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, requires, version

from packaging.requirements import Requirement
from packaging.specifiers import SpecifierSet

PROJECT = "flatgrasp"
FOR_DEVELOPERS = {"dev", "docs"}


@dataclass(frozen=True, slots=True)
class Package:
    """A package that the project, or one of its extras, wants here; `installed` is its version, None without one."""

    name: str
    wanted: str
    extra: str | None
    installed: str | None

    @property
    def sound(self) -> bool:
        """Whether it is there, and of a version that is wanted."""
        return self.installed is not None and SpecifierSet(self.wanted).contains(self.installed, prereleases=True)


def packages() -> list[Package]:
    """What is wanted on this system and by the extras for users; empty for a tree that was never installed."""
    try:
        wanted = [Requirement(line) for line in requires(PROJECT) or []]
    except PackageNotFoundError:
        return []
    here = [each for each in wanted if each.marker is None or each.marker.evaluate({"extra": _extra(each) or ""})]
    return [
        Package(each.name, str(each.specifier), _extra(each), _version(each.name))
        for each in here
        if _extra(each) not in FOR_DEVELOPERS
    ]


def _extra(requirement: Requirement) -> str | None:
    named = re.search(r"""extra == ["']([\w-]+)["']""", str(requirement.marker))
    return named and named[1]


def _version(name: str) -> str | None:
    try:
        return version(name)
    except PackageNotFoundError:
        return None
