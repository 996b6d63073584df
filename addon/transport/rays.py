"""What a ray meets first of many triangles: by `embreex` where installed, else by mathutils."""

from __future__ import annotations

import importlib.util
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray


def fast() -> bool:
    """Whether `embreex` is installed, which casts rays several times as fast as mathutils."""
    return importlib.util.find_spec("embreex") is not None


class Caster:
    """Triangles (n, 3, 3), near the origin, for float32 is fine there only; both faces count.

    ``slow``: by mathutils also where `embreex` is installed.
    """

    def __init__(self, corners: NDArray[np.float32], slow: bool = False) -> None:
        self.corners = np.ascontiguousarray(corners, np.float32)
        self.embree = fast() and not slow

    def build(self) -> None:
        """Make now what the first ray would make, which holds Python's lock: beside a window's
        events."""
        if len(self.corners):
            _ = self._scene if self.embree else self._tree

    def first_hits(
        self, origins: NDArray[np.float32], ways: NDArray[np.float32]
    ) -> NDArray[np.int32]:
        """Return the triangle that each ray (n, 3), (n, 3) meets first, -1 for none."""
        if not len(self.corners) or not len(origins):
            return np.full(len(origins), -1, np.int32)
        if self.embree:
            return self._scene.run(
                np.ascontiguousarray(origins), np.ascontiguousarray(ways), query="INTERSECT"
            )
        cast = self._tree.ray_cast
        found = (cast(o, d)[2] for o, d in zip(origins.tolist(), ways.tolist(), strict=True))
        return np.fromiter((-1 if i is None else i for i in found), np.int32, len(origins))

    @cached_property
    def _scene(self) -> Any:
        from embreex.mesh_construction import TriangleMesh
        from embreex.rtcore_scene import EmbreeScene

        scene = EmbreeScene(robust=True)  # no ray slips through between two triangles
        TriangleMesh(scene, self.corners)
        ray = np.array([[0.0, 0.0, 1.0]], np.float32)
        scene.run(ray, ray)  # the first call builds, which threads must not do twice
        return scene

    @cached_property
    def _tree(self) -> Any:
        from mathutils.bvhtree import BVHTree

        vertices = self.corners.reshape(-1, 3).tolist()
        triangles = np.arange(len(vertices)).reshape(-1, 3).tolist()
        return BVHTree.FromPolygons(vertices, triangles, all_triangles=True)
