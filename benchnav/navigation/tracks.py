"""Knowledge tracks: the map that a navigator is granted. The runner passes it no other map.

known    static geometry as it is now; its revision rises when obstacles are re-placed
stale    static geometry as it was before it moved; never corrected
partial  walls only
unknown  no map
"""

from dataclasses import replace

import numpy as np

from benchnav.arena.mesh import Mesh
from benchnav.arena.solid import Kind, Solid
from benchnav.arena.world import World
from benchnav.arrays import FloatArray
from benchnav.navigation.map import Map


def granted_map(
    world: World, track: str, body_position: FloatArray | None = None, revision: int = 0
) -> Map | None:
    """Return the map of ``world`` that ``track`` grants.

    Args:
        world: the drawn world.
        track: one of `benchnav.scenario.terms.TRACKS`.
        body_position: (M, 2) [m] the positions of its bodies now; None: at the start.
        revision: how often static obstacles were re-placed so far.

    Dynamic obstacles are on no map. A map shares no data with the world: code that holds a map
    cannot reach the world through it, and cannot move its walls.
    """
    if track == "unknown":
        return None
    if track == "partial":
        walls = tuple(solid for solid in world.solids if solid.kind == Kind.WALL)
        return Map(world.bounds, _copied(walls))
    if track == "stale":
        old = world.stale_solids
        solids = world.solids if old is None else old
        meshes = world.meshes if old is None else ()
        return Map(world.bounds, _copied(solids + _placed(world, None)), 0, _apart(meshes))
    solids = world.solids + _placed(world, body_position)
    return Map(world.bounds, _copied(solids), revision, _apart(world.meshes))


def _placed(world: World, position: FloatArray | None) -> tuple[Solid, ...]:
    """Return the static bodies at ``position`` (M, 2) [m]; None: at the start."""
    return tuple(
        body.solid.moved(body.law.points[0] if position is None else position[m])
        for m, body in enumerate(world.bodies)
        if body.solid.kind == Kind.STATIC
    )


def _copied(solids: tuple[Solid, ...]) -> tuple[Solid, ...]:
    """Return the same solids with read-only copies of the arrays."""
    copies = tuple(replace(solid, loops=tuple(map(np.copy, solid.loops))) for solid in solids)
    for solid in copies:
        for array in (*solid.loops, solid.capsules):
            array.setflags(write=False)
    return copies


def _apart(meshes: tuple[Mesh, ...]) -> tuple[Mesh, ...]:
    return tuple(
        replace(mesh, vertices=mesh.vertices.copy(), faces=mesh.faces.copy()) for mesh in meshes
    )
