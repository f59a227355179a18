"""Names of the walls, obstacles and agents that an agent touches."""

from collections.abc import Iterator, Sequence

import numpy as np

from benchnav.arena.agents import Role
from benchnav.arena.body import LawKind
from benchnav.arena.solid import Kind, Solid, is_outside
from benchnav.arena.world import World
from benchnav.arrays import FloatArray

_LAWS = {
    LawKind.TRACK: "moving obstacle", LawKind.CIRCLE: "circling obstacle",
    LawKind.RELOCATE: "re-placed obstacle",
}  # fmt: skip


def partner_name(world: World, kind: int, partner: int) -> str:
    """Return the name of a contact's partner, such as ``static obstacle 3``.

    ``kind`` and ``partner`` are those of `benchnav.episode.episode.Contacts`. Obstacles have
    numbers from 1, each kind in the order of the world; agents have the name of their team.
    """
    if kind == Kind.AGENT:
        return _agent(world, partner)
    if partner < 0:
        index = -1 - partner
        body = world.bodies[index]
        return f"{'recorded person' if body.person else _LAWS[body.law.kind]} {index + 1}"
    solid = world.solids[partner]
    if solid.kind == Kind.STATIC:
        return f"static obstacle {_number(world.solids, partner)}"
    return "outer wall" if is_outside(solid) else f"wall {_number(world.solids, partner)}"


def obstacles_of(world: World) -> Iterator[tuple[str, FloatArray, Solid]]:
    """Yield the name, a point (2,) [m] and the shape of every wall, obstacle and moving obstacle.

    The point is the middle of an obstacle, or of the longest edge of a wall.
    """
    for k, solid in enumerate(world.solids):
        yield partner_name(world, int(solid.kind), k), _point(solid), solid
    for k, body in enumerate(world.bodies):
        name = partner_name(world, int(body.solid.kind), -1 - k)
        yield name, np.asarray(body.law.points[0], np.float64), body.solid


def fixed_obstacles(worlds: Sequence[World]) -> set[str]:
    """Return the names of walls and obstacles that are the same in all ``worlds``."""
    first, *others = (_shapes(world) for world in worlds)
    return {
        name for name, shape in first.items() if all(shape == other.get(name) for other in others)
    }


def without_number(name: str) -> str:
    """Return the name of an obstacle or wall without its number: ``a static obstacle``."""
    kind, _, number = name.rpartition(" ")
    return f"a {kind}" if number.isdigit() else name


def _point(solid: Solid) -> FloatArray:
    ends = solid.capsules[:, :4].reshape(-1, 2, 2)
    if solid.kind == Kind.WALL:
        ends = ends[[int(np.argmax(np.hypot(*(ends[:, 1] - ends[:, 0]).T)))]]
    middle: FloatArray = 0.5 * (ends.min(axis=(0, 1)) + ends.max(axis=(0, 1)))
    return middle


def _shapes(world: World) -> dict[str, bytes]:
    return {
        name: point.tobytes() + solid.capsules.tobytes()
        for name, point, solid in obstacles_of(world)
    }


def _agent(world: World, agent: int) -> str:
    agents = world.agents
    team = world.teams[int(agents.team[agent])]
    if not agents.evaluated[agent]:
        return f"background agent of team {team}"
    role = Role(agents.role[agent]).name.lower()
    return f"{role} of team {team}" if len(world.teams) > 1 else f"another {role}"


def _number(solids: Sequence[Solid], index: int) -> int:
    """Return the number of a solid among those of its kind; an outer wall comes first."""
    kind = solids[index].kind
    count = sum(solid.kind == kind for solid in solids[: index + 1])
    return count - (kind == Kind.WALL and is_outside(solids[0]))
