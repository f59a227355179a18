"""A triangle mesh in an arena, in addition to its cross-section.

Sensing and contact use the cross-section (a planar solid); the mesh itself is
for the second, three-dimensional collision checker.
"""

from dataclasses import dataclass

from benchnav.arrays import FloatArray, IntArray


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles in the arena's frame, z up."""

    vertices: FloatArray  # (V, 3) [m]
    faces: IntArray  # (F, 3)
    band: tuple[float, float]  # height band [m] of the agents, in which the mesh is an obstacle
