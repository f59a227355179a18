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
    count = _spread(int((w.agents.team == team).sum()) for w in worlds)
    if not len(members):
        return f"{count} agents"
    one = members[0]
    role = Role(agents.role[one]).name.lower()
    kind = Dynamics(agents.dynamics[one]).name.lower()
    text = (
        f"{count} × {kind} {role}, radius {agents.radius[one]:.3g} m,"
        f" up to {agents.max_speed[one]:.3g} m/s"
    )
    return text if agents.evaluated[one] else f"{text}; background, not evaluated"


def _parameters(config: Mapping[str, Any]) -> Iterator[Fact]:
    for name, declared in config.get("parameters", {}).items():
        about = f" ({declared['description']})" if declared.get("description") else ""
        yield f"parameter {name}", f"{declared['default']:g} by default{about}"


def _spread(counts: Iterable[int]) -> str:
    """Return ``6`` or ``6 to 10``."""
    every = sorted(counts)
    return f"{every[0]}" if every[0] == every[-1] else f"{every[0]} to {every[-1]}"
