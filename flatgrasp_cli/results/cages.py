"""The grasps and cages of one outline as a document of schema `flatgrasp.cage/1`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any, cast

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.methods.allen import cage_of
from flatgrasp_cli.profiles.settings import CagingSettings
from flatgrasp_cli.proof.caging import Immobilisation
from flatgrasp_cli.results.contracts.cage import SCHEMA_ID, CageDocument, PointGraspPart
from flatgrasp_cli.results.contracts.grasps import CagePart

NO_HOLD = "no two points hold this outline without friction; a convex one has none that do"
NO_OUTLINE = "the points are too scattered for an outline"


def cage_document(
    source: str,
    thing: int | None,
    loops: Sequence[FloatArray],
    found: Sequence[Immobilisation],
    settings: CagingSettings,
) -> dict[str, Any]:
    """All grasps of two point fingers on an outline `loops` (n_l, 2), the one that forgives most first.

    `thing` is the object's number in its cloud, None for a polygon. Lengths are in the outline's own unit.
    """
    document = CageDocument(
        schema=SCHEMA_ID,
        source=source,
        object=thing,
        closing=settings.closing,
        loops=[loop.tolist() for loop in loops],
        reason=None if found else NO_HOLD if loops else NO_OUTLINE,
        grasps=[
            PointGraspPart(
                rank=k + 1,
                contacts=one.contacts.tolist(),
                width_m=one.width_m,
                cage=cast(CagePart, asdict(cage_of(one, settings.closing))),
            )
            for k, one in enumerate(found)
        ],
    )
    return dict(document)
