"""The facts about a scenario, from its stored worlds and its configuration."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from benchnav.arena.agents import Dynamics, Role
from benchnav.arena.body import LawKind
from benchnav.arena.solid import Kind
from benchnav.arena.world import ContactRule, World

Fact = tuple[str, str]
_CONTACTS = {
    ContactRule.SLIDE: "an agent slides along what it touches",
    ContactRule.STOP: "an agent stands still until its next decision",
    ContactRule.END: "the attempt of the agent ends",
}


def scenario_facts(
    config: Mapping[str, Any], worlds: Sequence[World], digest: str
) -> list[Fact]:  # fmt: skip
    """Return the facts about a scenario; counts are those of the stored ``worlds``."""
    return [*(_world_facts(worlds) if worlds else ()), *_parameters(config), ("hash", digest)]


def _world_facts(worlds: Sequence[World]) -> Iterator[Fact]:
    world = worlds[0]
    x0, y0, x1, y1 = world.bounds
    yield "arena", f"{x1 - x0:g} m × {y1 - y0:g} m"
    for k, team in enumerate(world.teams):
        yield f"team {team}", _team(worlds, k)
    static = _spread(sum(s.kind == Kind.STATIC for s in w.solids) for w in worlds)
    moving = _spread(sum(b.law.kind != LawKind.RELOCATE for b in w.bodies) for w in worlds)
    again = _spread(sum(b.law.kind == LawKind.RELOCATE for b in w.bodies) for w in worlds)
    counts = [("static", static), ("moving", moving), ("re-placed during the episode", again)]
    yield "obstacles", ", ".join(f"{n} {kind}" for kind, n in counts if n != "0") or "none"
    yield "time", f"{world.clock.horizon:g} s, a decision every {world.clock.dt:g} s"
    yield "at a contact", _CONTACTS[world.rules.contact]
    yield "arrival", f"within {world.rules.goal_tolerance:g} m of the goal"


def _team(worlds: Sequence[World], team: int) -> str:
    agents = worlds[0].agents
    members = np.flatnonzero(agents.team == team)
    if not len(members):
        return "no agents in the first world"
    one = members[0]
    count = " and ".join(_members(worlds, team, role) for role in _roles(worlds, team))
    kind = Dynamics(agents.dynamics[one]).name.lower().replace("_", " ")
    text = f"{count}, {kind}, radius {agents.radius[one]:.3g} m, up to {agents.max_speed[one]:.3g}"
    return f"{text} m/s" if agents.evaluated[one] else f"{text} m/s; background, not evaluated"


def _roles(worlds: Sequence[World], team: int) -> list[Role]:
    return [r for r in Role if any(_count(w, team, r) for w in worlds)]


def _members(worlds: Sequence[World], team: int, role: Role) -> str:
    count = _spread(_count(world, team, role) for world in worlds)
    return f"{count} {role.name.lower()}{'' if count == '1' else 's'}"


def _count(world: World, team: int, role: Role) -> int:
    return int(((world.agents.team == team) & (world.agents.role == role)).sum())


def _parameters(config: Mapping[str, Any]) -> Iterator[Fact]:
    for name, declared in config.get("parameters", {}).items():
        about = f" ({declared['description']})" if declared.get("description") else ""
        default = declared["default"]
        shown = f"{default:g}" if type(default) in (int, float) else str(default)
        yield f"parameter {name}", f"{shown} by default{about}"


def _spread(counts: Iterable[int]) -> str:
    """Return ``6`` or ``6 to 10``."""
    every = sorted(counts)
    return f"{every[0]}" if every[0] == every[-1] else f"{every[0]} to {every[-1]}"
