"""Mesh files → clouds: one module a format, each into polygons; their surface is then sampled, or given as triangles.

STL, OBJ, OFF and PLY are read here and not by Open3D, which, seen with 0.20 on broken files, answers with part of the
faces, with indices beyond the vertices, or with all the memory there is, and no exception; a GLB or glTF file goes to
Open3D as a clean copy, and its triangles are counted.
"""

from flatgrasp_cli.sources.meshes.gltf import UP_ASSUMED, is_gltf, read_gltf
from flatgrasp_cli.sources.meshes.mesh import Polygons, polygon_cloud, surface
from flatgrasp_cli.sources.meshes.obj import is_obj, read_obj
from flatgrasp_cli.sources.meshes.off import is_off, read_off
from flatgrasp_cli.sources.meshes.stl import is_stl, read_stl

__all__ = [
    "UP_ASSUMED",
    "Polygons",
    "is_gltf",
    "is_obj",
    "is_off",
    "is_stl",
    "polygon_cloud",
    "read_gltf",
    "read_obj",
    "read_off",
    "read_stl",
    "surface",
]
