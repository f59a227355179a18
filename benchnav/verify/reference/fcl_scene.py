"""A world in python-fcl, built with trimesh: a second geometry for the referee.

Planar shapes stand upright: loops become side walls of triangles, discs and agents become
spheres in the plane between. The gap between sphere and wall is the planar gap.
"""

import math
from typing import Any

import fcl
import numpy as np
import trimesh

from benchnav.arena.solid import Solid
from benchnav.arena.world import World
from benchnav.arrays import FloatArray
from benchnav.verify.reference.reference_footprint import Footprints

HALF = 10.0  # [m] half height of side walls: more than the width of any agent
FLAT = 1e-7  # [m] thickness of a core that has none
_MAX_CONTACTS = 64  # triangles per pair that python-fcl reports


class Scene:
    """Objects of solids, bodies and agents; they are moved before each query."""

    def __init__(self, world: World) -> None:
        self.solids = [_object(solid) for solid in world.solids]
        self.bodies = [_object(body.solid) for body in world.bodies]
        self.shapes = Footprints(world.agents)
        self.agents = [self._agent(world, i) for i in range(len(world.agents))]

    def _agent(self, world: World, i: int) -> Any:
        """Return the disc of an agent as a sphere; of another shape, its core as a flat box."""
        if not self.shapes.shaped[i]:
            return fcl.CollisionObject(fcl.Sphere(float(world.agents.radius[i])))
        x, y = 2.0 * self.shapes.core(i, 0.0).max(axis=0)
        return fcl.CollisionObject(fcl.Box(x, max(y, FLAT), FLAT))

    def gap(
        self, i: int, place: FloatArray, heading: FloatArray, other: tuple[str, int], at: FloatArray
    ) -> float:
        """Return the gap [m] between agent i at ``place`` (2,) and a partner at ``at`` (2,).

        ``heading`` (A,) [rad] turns agents that are not discs. Negative: the depth of the overlap;
        for a shape that contains the agent's centre, how far the agent extends out of it. Of
        agents that are not discs, it is at most the depth at which their cores meet.
        """
        name, k = other
        agent, partner = self.agents[i], getattr(self, name)[k]
        both = [i, k] if name == "agents" else [i]
        margin = sum(float(self.shapes.rounding[a]) for a in both if self.shapes.shaped[a])
        _move(agent, place, float(heading[i]))
        if name != "solids":
            _move(partner, at, float(heading[k]) if name == "agents" else 0.0)
        if margin > 0.0:
            return max(0.0, float(fcl.distance(agent, partner))) - margin
        found = fcl.CollisionResult()
        request = fcl.CollisionRequest(num_max_contacts=_MAX_CONTACTS, enable_contact=True)
        if fcl.collide(agent, partner, request, found):
            return -max(abs(float(contact.penetration_depth)) for contact in found.contacts)
        return max(0.0, float(fcl.distance(agent, partner)))


def _move(thing: Any, place: FloatArray, heading: float) -> None:
    turn = np.array([math.cos(0.5 * heading), 0.0, 0.0, math.sin(0.5 * heading)])
    thing.setTransform(fcl.Transform(turn, np.array([place[0], place[1], 0.0])))


def _object(solid: Solid) -> Any:
    if solid.is_disc:
        x, y = solid.center
        if (x, y) == (0.0, 0.0):
            return fcl.CollisionObject(fcl.Sphere(solid.radius))
        place = fcl.Transform(np.array([x, y, 0.0]))
        return fcl.CollisionObject(fcl.Sphere(solid.radius), place)
    mesh = _side_walls(solid)
    model = fcl.BVHModel()
    model.beginModel(len(mesh.vertices), len(mesh.faces))
    model.addSubModel(mesh.vertices, mesh.faces)
    model.endModel()
    return fcl.CollisionObject(model)


def _side_walls(solid: Solid) -> Any:
    corners, faces, first = [], [], 0
    for loop in solid.loops:
        n = len(loop)
        i, j = first + np.arange(n), first + (np.arange(n) + 1) % n
        faces += [np.column_stack([i, j, j + n]), np.column_stack([i, j + n, i + n])]
        corners += [np.column_stack([loop, np.full(n, z)]) for z in (-HALF, HALF)]
        first += 2 * n
    return trimesh.Trimesh(np.vstack(corners), np.vstack(faces), process=False)


def extent(solid: Solid) -> tuple[FloatArray, FloatArray]:
    """Return the lowest and highest corner (2,), (2,) [m] of a shape."""
    c = solid.capsules
    ends = np.vstack([c[:, :2], c[:, 2:4]])
    rim = float(c[:, 4].max(initial=0.0))
    if not len(ends):
        return np.full(2, math.inf), np.full(2, -math.inf)
    return ends.min(axis=0) - rim, ends.max(axis=0) + rim
