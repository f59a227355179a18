"""Leader arena: 7 thick rays and a step with contacts, 1,024 worlds of `leaders/dynamic`.

Four unicycles per world drive at random. Contacts block and slide instead of ending an
attempt, so that all stay active among walls, cubes and movers; only active agents count.
Sensing and stepping are timed.
"""

from dataclasses import replace
from functools import cache, partial
from time import perf_counter

import numpy as np

from benchmarks.pair import Pair
from benchnav.arena.world import ContactRule, World
from benchnav.generation.build import build
from benchnav.scenario.catalogue import find
from benchnav.sensors.sense import sense
from benchnav.world.simulation import Simulation

WORLDS, DRAWN, STEPS = 1024, 128, 25
RATE = 2e6  # agent-steps per second to reach
ONE = 1e6 / 60.0  # steps per second of one world to reach: 60 µs for each
LIMIT = "Rays take more than half of the time, mostly to list what they may meet."
RAYS = frozenset({"rays"})


def pairs() -> list[Pair]:
    """Return the pair of many worlds, and that of one."""
    return [
        Pair(
            name="leader arena, 1,024 × 4 agents, 7 rays, contacts", unit="agent-steps/s",
            ours=partial(rate, WORLDS, STEPS), wanted=RATE, limit=LIMIT,
        ),
        Pair(
            name="leader arena, one world of 4 agents", unit="agent-steps/s",
            ours=partial(rate, 1, 8 * STEPS), wanted=4 * ONE, limit=LIMIT,
        ),
    ]  # fmt: skip


@cache
def drawn() -> list[World]:
    """Return `DRAWN` worlds."""
    scenario = find("leaders/dynamic")
    return [sliding(build(scenario, "train", seed)) for seed in range(DRAWN)]


def sliding(world: World) -> World:
    """Return the same world with agents that slide after a contact."""
    return replace(world, rules=replace(world.rules, contact=ContactRule.SLIDE))


def rate(worlds: int, count: int) -> float:
    """Return agent-steps per second of ``worlds`` over ``count`` steps of random driving."""
    simulation = Simulation([drawn()[k % DRAWN] for k in range(worlds)])
    rng = np.random.default_rng(0)
    chosen = np.tile(np.arange(simulation.A), (simulation.B, 1))
    twist = np.ones(chosen.shape, np.bool_)
    seconds, steps = 0.0, 0
    for _ in range(count):
        command = np.stack(
            [rng.uniform(0.0, 2.0, chosen.shape), rng.normal(0.0, 1.0, chosen.shape)], axis=-1
        )
        active = (simulation.status == 0) & simulation.present
        steps += int(active.sum())
        began = perf_counter()
        sense(simulation, np.where(active, chosen, -1), RAYS)
        simulation.step(command, twist)
        seconds += perf_counter() - began
    return steps / seconds
