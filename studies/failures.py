"""``python -m studies.failures [WEIGHTS]``: how and where a learned policy alone fails.

Drives validation worlds of `leaders/dynamic` and `leaders/dynamic-corner` with the policy, which
nothing corrects, and prints tables in Markdown: the objects that agents hit, how movers (moving
obstacles that never yield) hit them, success by the tracks at goals and starts, and success in
the same worlds without some of their parts. Without WEIGHTS: the included ones of `recurrent-ppo`.
"""

import argparse
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from benchnav_baselines.learned.recurrent_ppo.actor import Actor
from benchnav_baselines.learned.recurrent_ppo.policy_at_work import SHIPPED
from benchnav_baselines.learned.recurrent_ppo.sightings import memory_for
from benchnav_baselines.learned.recurrent_ppo.weights import read_weights

from benchnav.arena.body import Body
from benchnav.arena.solid import Kind
from benchnav.arena.world import World
from benchnav.arrays import BoolArray, FloatArray
from benchnav.envs import AgentBatch, RewardWeights, encoder
from benchnav.envs.agent_batch import Autoreset, Transition
from benchnav.generation.build import build
from benchnav.geometry.sweep import point_segment_distance2
from benchnav.navigation import Rays
from benchnav.navigation.observe import observe
from benchnav.scenario.catalogue import find
from benchnav.world.simulation import Simulation
from studies.paper.markdown import table

SCENARIOS = ("leaders/dynamic", "leaders/dynamic-corner")
RECENT = 5  # decisions: the last second
LATELY = 10  # decisions: a mover that turned within them has just reversed
BODIES = 1.21  # [m] the radius of an agent, and of the circle around a mover
NEAR = 2.2  # [m]
KINDS = ("dynamic", "static", "wall", "agent", "timeout")


@dataclass(frozen=True)
class Meeting:
    """The contact of an agent with a mover."""

    bearing: float  # [degrees] of the mover's centre: 0 ahead, 180 behind
    towards: float  # [m/s] speed of the mover towards the agent
    seen: bool  # whether a ray hit this mover at one of the last `RECENT` decisions
    reversed: bool  # whether it reversed within the last `LATELY` decisions


@dataclass(frozen=True)
class Attempt:
    """One agent in one world."""

    outcome: str  # "arrived", "timeout", or the kind of object of the first contact
    seconds: float
    goal_distance: float  # [m] at the end
    speed: float  # [m/s] mean of the last `RECENT` decisions
    goal_track: float  # [m] from the goal to the nearest track of a mover
    start_track: float  # [m]
    meeting: Meeting | None = None


@dataclass(frozen=True, eq=False)
class Moment:
    """The state of all worlds before a decision; bodies are the movers."""

    position: FloatArray  # (B, A, 2) [m]
    heading: FloatArray  # (B, A) [rad]
    velocity: FloatArray  # (B, A, 2) [m/s]
    body_position: FloatArray  # (B, M, 2) [m]
    body_velocity: FloatArray  # (B, M, 2) [m/s]
    rays: Rays

    def offset(self, b: int, a: int, m: int) -> tuple[FloatArray, float]:
        """Return the mover from the agent [m], and its bearing [degrees], 0 to 180."""
        away = self.body_position[b, m] - self.position[b, a]
        turn = np.arctan2(away[1], away[0]) - self.heading[b, a]
        return away, float(abs((np.degrees(turn) + 180.0) % 360.0 - 180.0))

    def hits(self, b: int, a: int, m: int) -> bool:
        """Whether a ray of the agent hits the mover."""
        angle = self.heading[b, a] + self.rays.angle
        ends = self.rays.distance[b, a][:, None] * np.stack([np.cos(angle), np.sin(angle)], -1)
        gap = np.linalg.norm(self.position[b, a] + ends - self.body_position[b, m], axis=-1)
        return bool(((self.rays.kind[b, a] == Kind.DYNAMIC) & (gap < BODIES + 0.1)).any())


def drive(actor: Actor, about: Mapping[str, Any], worlds: Sequence[World]) -> list[Attempt]:
    """Return the attempts of all agents of ``worlds``, which share clock and sensing.

    ``about`` holds the facts of the actor's weights.
    """
    batch = AgentBatch(
        worlds, len(worlds), encoder(about["encoder"]), RewardWeights(), np.random.default_rng(0),
        autoreset=Autoreset.DISABLED, reverse=False, memory=memory_for(about["hidden_movers"]),
    )  # fmt: skip
    seen = batch.reset(np.arange(len(worlds)))
    state = np.zeros((batch.active.size, actor.state_size), np.float32)
    moments: list[Moment] = []
    attempts: list[Attempt] = []
    while batch.active.any():
        moments = [*moments[-LATELY:], _moment(batch.simulation, batch.active)]
        slots = batch.active.reshape(-1)
        action, memory = np.zeros((len(slots), 2), np.float32), state[slots]
        action[slots] = actor.decide(seen.reshape(len(slots), -1)[slots], memory)
        state[slots] = memory
        step = batch.step(action.reshape(*batch.active.shape, 2))
        seen = step.observation
        attempts += list(_ended(batch.simulation, step, moments))
    return attempts


def _moment(simulation: Simulation, active: BoolArray) -> Moment:
    agents = np.tile(np.arange(simulation.A), (simulation.B, 1))
    no_maps = (None,) * simulation.B
    rays = observe(simulation, agents, active, frozenset({"rays"}), no_maps).rays
    assert rays is not None
    return Moment(
        simulation.position.copy(), simulation.heading.copy(), simulation.velocity.copy(),
        simulation.body_position.copy(), simulation.body_velocity.copy(), rays,
    )  # fmt: skip


def _ended(
    simulation: Simulation, step: Transition, moments: Sequence[Moment]
) -> Iterator[Attempt]:
    """Yield the attempts that ended in the last step; the last moment is before it."""
    for b, a in np.argwhere(step.over).tolist():
        world, recent = simulation.world(b), moments[-RECENT:]
        speeds = [np.linalg.norm(moment.velocity[b, a]) for moment in recent]
        goal, start = world.agents.goal[a], world.agents.start[a]
        outcome, meeting = "arrived" if step.arrived[b, a] else "timeout", None
        if step.touched[b, a]:
            contacts = simulation.contacts(b)
            first = np.flatnonzero((contacts.agent == a) & contacts.charged)[0]
            outcome = Kind(int(contacts.kind[first])).name.lower()
            if outcome == "dynamic":
                meeting = _meeting(moments, b, a, -1 - int(contacts.partner[first]))
        yield Attempt(
            outcome, float(simulation.steps_done[b] * world.clock.dt),
            float(np.linalg.norm(goal - moments[-1].position[b, a])), float(np.mean(speeds)),
            _to_track(goal, world), _to_track(start, world), meeting,
        )  # fmt: skip


def _meeting(moments: Sequence[Moment], b: int, a: int, m: int) -> Meeting:
    now = moments[-1]
    away, bearing = now.offset(b, a, m)
    speed = now.body_velocity[b, m]
    return Meeting(
        bearing,
        float(-(speed @ away) / np.linalg.norm(away)),
        any(moment.hits(b, a, m) for moment in moments[-RECENT:]),
        any(float(moment.body_velocity[b, m] @ speed) < 0.0 for moment in moments[-LATELY:]),
    )


def _to_track(point: FloatArray, world: World) -> float:
    """Return the distance [m] of a point to the nearest track between two points."""
    ends = [body.law.points[:2] for body in world.bodies if len(body.law.points) > 1]
    return min(
        (float(point_segment_distance2(*point, *one, *two)) ** 0.5 for one, two in ends),
        default=np.inf,
    )


def without_static(world: World) -> World:
    """Return the world without obstacles that stand."""
    kept = tuple(solid for solid in world.solids if solid.kind != Kind.STATIC)
    return replace(world, solids=kept)


def without_movers(world: World) -> World:
    """Return the world without movers."""
    return replace(world, bodies=())


def slower(world: World, factor: float = 2.0) -> World:
    """Return the world with movers of 1 / ``factor`` of their speed."""

    def slow(body: Body) -> Body:
        law = body.law
        return replace(body, law=replace(law, times=factor * law.times, phase=factor * law.phase))

    return replace(world, bodies=tuple(slow(body) for body in world.bodies))


CHANGES: dict[str, Callable[[World], World]] = {
    "as they are": lambda world: world,
    "no static obstacles": without_static,
    "no movers": without_movers,
    "movers at half speed": slower,
}


def page(by_scenario: dict[str, dict[str, list[Attempt]]]) -> list[str]:
    """Return the tables of the attempts by scenario and change."""
    plain = {name: changed["as they are"] for name, changed in by_scenario.items()}
    every = [(name, how, a) for name, each in by_scenario.items() for how, a in each.items()]
    return [
        *table(
            ("worlds", "agents", "success %", *(f"{kind} %" for kind in KINDS)),
            ((f"`{n}`, {h}", str(len(a)), _share(a, "arrived"), *(_share(a, k) for k in KINDS))
             for n, h, a in every),
        ),
        *table(("hits by movers", *(f"`{name}`" for name in plain)), _meetings(plain.values())),
        *table(("success % (hit by a mover %)", *(f"`{name}`" for name in plain)),
               _by_track(plain.values())),
    ]  # fmt: skip


def _share(attempts: Sequence[Attempt], outcome: str) -> str:
    return f"{100 * np.mean([a.outcome == outcome for a in attempts]):.1f}"


def _meetings(columns: Iterable[list[Attempt]]) -> Iterator[tuple[str, ...]]:
    hits = [[a for a in attempts if a.meeting] for attempts in columns]

    def line(text: str, holds: Callable[[Any, Any], bool]) -> tuple[str, ...]:
        shares = ([holds(a, a.meeting) for a in column] for column in hits)
        return (text, *(f"{100 * np.mean(share):.0f} %" for share in shares))

    yield ("number", *(str(len(column)) for column in hits))
    for low, high in ((0, 45), (45, 90), (90, 135), (135, 181)):
        bearing = f"bearing {low}° to {min(high, 180)}°"
        yield line(bearing, lambda _, m, low=low, high=high: low <= m.bearing < high)
    yield line("a ray hit the mover in the last second", lambda _, m: m.seen)
    yield line("the mover came nearer at more than 0.3 m/s", lambda _, m: m.towards > 0.3)
    yield line("the mover had reversed within 2 s", lambda _, m: m.reversed)
    yield line("the agent stood (below 0.2 m/s)", lambda a, _: a.speed < 0.2)
    yield line("the agent drove faster than 1 m/s", lambda a, _: a.speed > 1.0)
    yield line("the goal was within 2 m", lambda a, _: a.goal_distance < 2.0)
    yield line("within 2 s of the start", lambda a, _: a.seconds <= 2.0)


def _by_track(columns: Iterable[list[Attempt]]) -> Iterator[tuple[str, ...]]:
    attempts = list(columns)
    bands = (("on", 0.0, BODIES), ("beside", BODIES, NEAR), ("off", NEAR, np.inf))
    for what in ("goal", "start"):
        for word, low, high in bands:
            cells = []
            for column in attempts:
                here = [a for a in column if low <= getattr(a, f"{what}_track") <= high]
                cells.append(
                    f"{_share(here, 'arrived')} ({_share(here, 'dynamic')}) of {len(here)}"
                )
            yield (f"{what} {word} a track", *cells)


def main() -> None:
    """Drive, and print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("weights", type=Path, nargs="?", help="file of `benchnav train`")
    parser.add_argument("--worlds", type=int, default=500)
    options = parser.parse_args()
    actor, about = read_weights(options.weights or SHIPPED / "recurrent-ppo.safetensors")
    found: dict[str, dict[str, list[Attempt]]] = {}
    for name in SCENARIOS:
        worlds = [build(find(name), "validation", seed) for seed in range(options.worlds)]
        found[name] = {
            how: drive(actor, about, [change(world) for world in worlds])
            for how, change in CHANGES.items()
        }
    print("\n".join(page(found)))


if __name__ == "__main__":
    main()
