"""Options that are nothing to a source: whoever typed one is told that it changed nothing."""

from __future__ import annotations

from flatgrasp_cli.model import CloudWarning
from flatgrasp_cli.sources.selection import Selection

OF_RECORDINGS = ("topic", "start", "end", "at")
"""`--every`, `--count` and `--strict` are not among them: what they ask for holds of a single cloud as well."""
OF_IMAGES = ("intrinsics", "depth_unit", "depth_axes")


def idle_options(selection: Selection, *, recorded: bool, images: bool) -> tuple[CloudWarning, ...]:
    """The warning of typed options that say nothing of a source which is a recording or not, of depth images or not."""
    reasons = (
        (recorded, OF_RECORDINGS, "only a recording has topics and times"),
        (images, OF_IMAGES, "only depth images need a camera's intrinsics, unit and axes"),
    )
    texts = []
    for applies, names, why in reasons:
        typed = [f"--{name.replace('_', '-')}" for name in names if name in selection.typed and not applies]
        if typed:
            texts.append(f"{', '.join(typed)} changed nothing: {why}")
    return (CloudWarning("option_ignored", "; ".join(texts)),) if texts else ()
