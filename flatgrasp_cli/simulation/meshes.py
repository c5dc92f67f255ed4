"""A user's mesh as a thing: its convex pieces are found by CoACD (Wei et al., ACM TOG 41(4), 2022), in memory."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from flatgrasp_cli.errors import SourceError, UsageError
from flatgrasp_cli.simulation.engine import EXTRA
from flatgrasp_cli.simulation.solids import Mesh, volume
from flatgrasp_cli.simulation.things import Thing, mesh_thing
from flatgrasp_cli.source_names import in_utf8
from flatgrasp_cli.sources.files import read_surface

CONCAVITY = 0.05
"""How far a piece may be from convex, as CoACD measures it: its own default."""
SEARCH = {"mcts_iterations": 40, "mcts_nodes": 10, "mcts_max_depth": 2, "resolution": 1000}
"""A shorter search than CoACD's own: seconds a mesh instead of half a minute, for a tenth more pieces."""
SMALLEST_M, LARGEST_M = 0.005, 1.0
"""What hands on arms hold is longer than a pea and shorter than a broom; all else is in another unit."""
LEAST_SHARE = 1e-4
"""Of the largest piece's volume; smaller pieces bear nothing and have no inertia that can be computed."""


def mesh_file_thing(path: str, scale: float = 1.0, mass_kg: float | None = None) -> Thing:
    """The thing of a mesh file.

    Raises
    ------
    SourceError
        If it is no mesh, far too small or too large for a hand, or has no volume.
    UsageError
        If CoACD is not installed.
    """
    file, called = Path(path), in_utf8(path)
    places, triangles = read_surface(file, called, scale)
    vertices, index = np.unique(places[triangles].reshape(-1, 3), axis=0, return_inverse=True)
    size = float(np.ptp(vertices, axis=0).max()) if len(vertices) else 0.0
    if not SMALLEST_M <= size <= LARGEST_M:
        raise SourceError(
            f"{called}: is {size:.4g} m long; things of {SMALLEST_M} to {LARGEST_M:g} m are simulated; "
            "--scale 0.001 says that its unit is the millimetre"
        )
    surface = Mesh(vertices, index.reshape(-1, 3))
    pieces = convex_pieces(surface)
    if not pieces:
        raise SourceError(f"{called}: the mesh fills no volume, nothing could be gripped; is it a sheet?")
    return mesh_thing(in_utf8(file.stem), surface, pieces, mass_kg)


def convex_pieces(surface: Mesh) -> tuple[Mesh, ...]:
    """Convex pieces that fill a closed surface, always the same for the same surface."""
    try:
        import coacd
    except ImportError as error:
        raise UsageError(f"simulating a mesh needs {error.name}, which is not installed: {EXTRA}") from error
    coacd.set_log_level("error")
    parts = coacd.run_coacd(coacd.Mesh(surface.vertices, surface.faces), threshold=CONCAVITY, seed=0, **SEARCH)
    pieces = [Mesh(np.asarray(vertices), np.asarray(faces, dtype=np.intp)) for vertices, faces in parts]
    volumes = [volume(piece) for piece in pieces]
    least = LEAST_SHARE * max(volumes, default=0.0)
    return tuple(piece for piece, size in zip(pieces, volumes, strict=True) if size > least)
