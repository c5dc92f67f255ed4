"""What can go wrong for a user, one class per exit code.

The text of each says what is wrong, where, and what to do; it fits one or two lines.
"""

from __future__ import annotations


class FlatgraspError(Exception):
    """Base of everything flatgrasp raises on purpose; `exit_code` is the process's."""

    exit_code = 2


class UsageError(FlatgraspError):
    """A wrong option or an output that cannot be written."""


class FigureError(UsageError):
    """A picture that cannot be drawn; what it would show is not lost by that."""


class ProfileError(FlatgraspError):
    """A gripper, robot or planner profile that is missing, malformed or out of range."""


class InstallationError(FlatgraspError):
    """An installation that cannot work."""


class SourceError(FlatgraspError):
    """An input that cannot be read or holds no usable cloud."""

    exit_code = 3


class NoFramesError(SourceError):
    """A recording that can be read, but has no usable frame of those that were asked for."""
