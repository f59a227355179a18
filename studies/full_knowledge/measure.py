"""How often plans made with full knowledge arrive, as the simulator sees it."""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from time import perf_counter

import numpy as np

from benchnav.arena.world import World
from benchnav.arrays import ByteArray
from benchnav.episode.episode import Status
from benchnav.generation.build import build
from benchnav.leaderboard.statistics.interval import effective_size, mid_p
from benchnav.scenario.catalogue import find
from benchnav.world.simulation import Simulation

from .plan import Plan, plans

_ARRIVED, _ENDED = int(Status.ARRIVED), int(Status.ENDED)


@dataclass(frozen=True)
class Outcome:
    """The outcome of the agents of one world."""

    seed: int
    agents: int
    arrived: int
    collided: int
    not_found: int  # agents without a plan; they stand, and may be hit
    broken: int  # agents with a plan that did not arrive
    seconds: float  # of planning and driving, one core


def measure(scenario: str, split: str, seeds: Iterable[int]) -> list[Outcome]:
    """Plan and drive the worlds of ``scenario`` for ``seeds`` of ``split``."""
    drawn = find(scenario)
    return [outcome(build(drawn, split, seed), seed) for seed in seeds]


def outcome(world: World, seed: int) -> Outcome:
    """The best round of planning, judged by the simulator."""
    began = perf_counter()
    best = max((judged(world, seed, made) for made in plans(world, seed)), key=lambda o: o.arrived)
    return replace(best, seconds=perf_counter() - began)


def judged(world: World, seed: int, made: list[Plan]) -> Outcome:
    """One round, driven."""
    status = driven(world, made)
    planned = np.array([plan.found for plan in made])
    return Outcome(
        seed, len(made), int((status == _ARRIVED).sum()), int((status == _ENDED).sum()),
        int((~planned).sum()), int((planned & (status != _ARRIVED)).sum()), 0.0,
    )  # fmt: skip


def driven(world: World, made: list[Plan]) -> ByteArray:
    """(A,) of Status after the simulator has executed the plans."""
    simulation = Simulation([world])
    for step in range(world.clock.steps):
        if not simulation.running[0]:
            break
        execute(simulation, made, step)
    status: ByteArray = simulation.status[0].copy()
    return status


def execute(simulation: Simulation, made: list[Plan], step: int) -> None:
    """One decision of the simulator: the plans' twists, zero where a plan is over."""
    command = np.zeros((1, len(made), 2))
    for i, plan in enumerate(made):
        if step < len(plan.commands):
            command[0, i] = plan.commands[step]
    simulation.step(command, np.ones((1, len(made)), np.bool_))


@dataclass(frozen=True)
class Summary:
    """One scenario; shares are per agent."""

    scenario: str
    split: str
    worlds: int
    agents: int
    success: float
    low: float  # 95 % interval of success, agents clustered by world
    high: float
    collided: float
    not_found: float
    broken: float
    incomplete: list[int]  # seeds of worlds in which not all arrived
    seconds: float  # a world

    def __str__(self) -> str:
        return (
            f"{self.scenario}: success {self.success:.4f} [{self.low:.4f}, {self.high:.4f}] of"
            f" {self.agents} agents in {self.worlds} worlds; not found {self.not_found:.4f},"
            f" collided {self.collided:.4f}, plan broken {self.broken:.4f};"
            f" {self.seconds:.2f} s a world"
        )


def summary(scenario: str, split: str, outcomes: list[Outcome]) -> Summary:
    """Shares over the agents of all worlds."""
    agents = np.array([[float(o.agents)] for o in outcomes])
    rates = np.array([[o.arrived / o.agents] for o in outcomes])
    total = int(agents.sum())
    success = sum(o.arrived for o in outcomes) / total
    low, high = mid_p(np.array([success]), effective_size(rates, agents))
    return Summary(
        scenario, split, len(outcomes), total, success, float(low[0]), float(high[0]),
        sum(o.collided for o in outcomes) / total,
        sum(o.not_found for o in outcomes) / total,
        sum(o.broken for o in outcomes) / total,
        [o.seed for o in outcomes if o.arrived < o.agents],
        sum(o.seconds for o in outcomes) / len(outcomes),
    )  # fmt: skip
