"""Names of the walls, obstacles and agents that an agent touches."""

from collections.abc import Sequence

from benchnav.arena.agents import Role
from benchnav.arena.body import LawKind
from benchnav.arena.solid import Kind, Solid, signed_area
from benchnav.arena.world import World

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
        return f"{_LAWS[world.bodies[index].law.kind]} {index + 1}"
    solid = world.solids[partner]
    if solid.kind == Kind.STATIC:
        return f"static obstacle {_number(world.solids, partner)}"
    return "outer wall" if _is_outer(solid) else f"wall {_number(world.solids, partner)}"


def solid_names(world: World) -> list[str]:
    """Return the name of every wall and static obstacle, in the order of ``world.solids``."""
    return [partner_name(world, int(s.kind), k) for k, s in enumerate(world.solids)]


def _agent(world: World, agent: int) -> str:
    agents = world.agents
    team = world.teams[int(agents.team[agent])]
    if not agents.evaluated[agent]:
        return f"background agent of team {team}"
    role = Role(agents.role[agent]).name.lower()
    return f"{role} of team {team}" if len(world.teams) > 1 else f"another {role}"


def _number(solids: Sequence[Solid], index: int) -> int:
    """Return the number of a solid among those of its kind, without the outer wall."""
    kind = solids[index].kind
    return sum(s.kind == kind and not _is_outer(s) for s in solids[: index + 1])


def _is_outer(solid: Solid) -> bool:
    """Whether a solid is the outside of a walled arena."""
    return solid.kind == Kind.WALL and sum(map(signed_area, solid.loops)) < 0.0
