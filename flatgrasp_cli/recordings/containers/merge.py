"""Messages of many chunks or files in order of time, opening each only when its time comes."""

from __future__ import annotations

import heapq
from collections.abc import Callable, Iterable, Iterator
from typing import TypeVar

MAX_OPEN = 32
"""Sources held open at once; where more than that overlap, messages come slightly out of order instead."""

T = TypeVar("T")


def in_order(sources: Iterable[tuple[int, Callable[[], Iterator[T]]]], stamp: Callable[[T], int]) -> Iterator[T]:
    """Merge sources that are each in order of `stamp` and tell a lower bound of it.

    Parameters
    ----------
    sources
        Pairs of the lower bound and a function that opens the source.
    """
    waiting = sorted(enumerate(sources), key=lambda item: item[1][0], reverse=True)
    active: list[tuple[int, int, T, Iterator[T]]] = []
    while waiting or active:
        while waiting and len(active) < MAX_OPEN and (not active or waiting[-1][1][0] <= active[0][0]):
            number, (_, opening) = waiting.pop()
            _push(active, number, opening(), stamp)
        if not active:
            continue
        _, number, item, rest = heapq.heappop(active)
        yield item
        _push(active, number, rest, stamp)


def _push(
    active: list[tuple[int, int, T, Iterator[T]]], number: int, source: Iterator[T], stamp: Callable[[T], int]
) -> None:
    for item in source:
        # the number is unique in the heap, so items themselves are never compared
        heapq.heappush(active, (stamp(item), number, item, source))
        return
