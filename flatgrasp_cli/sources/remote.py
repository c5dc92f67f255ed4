"""Sources that are URLs, through fsspec: s3://, gs://, http://, file:// and what else it knows."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import PurePosixPath
from typing import IO, Any

from flatgrasp_cli.errors import SourceError

EXTRA = "pip install 'flatgrasp[remote]'"


def is_url(source: str) -> bool:
    """Whether a source is a URL and not a path."""
    return "://" in source


def copy_url(url: str, target: IO[bytes]) -> None:
    """Copy what a URL names to an open file.

    Raises
    ------
    SourceError
        If it cannot be read.
    """
    with _reporting(url):
        import fsspec

        with fsspec.open(url, "rb") as remote:
            shutil.copyfileobj(remote, target)


def list_url(url: str, suffixes: tuple[str, ...]) -> Iterator[tuple[str, PurePosixPath]]:
    """The URL itself, or the files below it that end in one of `suffixes`, with their places below it.

    Raises
    ------
    SourceError
        If it cannot be read.
    """
    with _reporting(url):
        import fsspec

        files, root = fsspec.core.url_to_fs(url)
        if "*" in root:
            matches, base = files.glob(root), PurePosixPath(root.split("*")[0]).parent
        elif files.isdir(root):
            matches, base = files.find(root), PurePosixPath(root)
        else:
            yield url, PurePosixPath(PurePosixPath(root).name)
            return
        for match in sorted(matches):
            place = PurePosixPath(match)
            if place.suffix.lower() in suffixes:
                yield files.unstrip_protocol(match), place.relative_to(base)


def url_state(url: str) -> str:
    """What changes when the content behind a URL does, as far as its server tells; "" when it cannot be read."""
    try:
        with _reporting(url):
            import fsspec

            files, path = fsspec.core.url_to_fs(url)
            info: dict[str, Any] = files.info(path)
    except SourceError:
        return ""
    return repr([info.get(key) for key in ("size", "ETag", "etag", "mtime", "LastModified", "updated")])


@contextmanager
def _reporting(url: str) -> Iterator[None]:
    """Turn what any of fsspec's file systems raises into one error of ours."""
    try:
        yield
    except ImportError as error:
        raise SourceError(f"{url}: needs more packages ({error.name or error}): {EXTRA}") from error
    except SourceError:
        raise
    except Exception as error:  # each file system has its own
        raise SourceError(f"{url}: cannot be read: {error or type(error).__name__}") from error
