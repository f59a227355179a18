"""The map that a knowledge track grants: static geometry, and nothing else."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from benchnav.arena.mesh import Mesh
from benchnav.arena.solid import Solid
from benchnav.arrays import Extent, FloatArray


@dataclass(frozen=True, eq=False)
class Map:
    """The static geometry that a knowledge track grants."""

    bounds: Extent  # xmin, ymin, xmax, ymax [m]
    solids: tuple[Solid, ...]  # walls and static obstacles
    revision: int = 0  # rises when geometry moves within an episode (track `known` only)
    meshes: tuple[Mesh, ...] = ()  # the 3D meshes of solids that were cut from a mesh

    @cached_property
    def capsules(self) -> FloatArray:
        """(P, 5) x0, y0, x1, y1, radius of the P capsules of all solids."""
        if not self.solids:
            return np.zeros((0, 5))
        return np.vstack([solid.capsules for solid in self.solids])
