"""Shell completion of profile names."""

from __future__ import annotations

from collections.abc import Callable

import click
from click.shell_completion import CompletionItem


def complete_profile(kind: str) -> Callable[[click.Context, click.Parameter, str], list[CompletionItem]]:
    """Completer of the shipped profiles' names of a kind, then of files."""

    def complete(_context: click.Context, _parameter: click.Parameter, incomplete: str) -> list[CompletionItem]:
        from flatgrasp_cli.profiles import list_profiles

        names = [CompletionItem(name) for name in list_profiles(kind) if name.startswith(incomplete)]
        return names or [CompletionItem(incomplete, type="file")]

    return complete
