"""Dynamics: the step with a differential drive, Ackermann bodies or accelerations, and a unicycle.

The worlds are those of `leader_arena`: the same discs drive at random by twists, which cost a
unicycle the least, among walls, cubes and movers, and slide. Only the step is timed.
"""

from dataclasses import replace
from functools import partial
from time import perf_counter

import numpy as np

from benchmarks.leader_arena import DRAWN, drawn
from benchmarks.pair import Pair
from benchnav.arena.agents import Dynamics
from benchnav.arena.world import World
from benchnav.world.simulation import Simulation

WORLDS, STEPS = 512, 50
WANTED = 0.8  # of the speed with unicycles
ACCELERATIONS = {
    "max_acceleration": 2.0, "max_deceleration": 4.0, "max_turn_acceleration": 8.0,
}  # fmt: skip
BODIES = {
    "unicycle": (Dynamics.UNICYCLE, {}),
    "unicycle with limits of acceleration": (Dynamics.UNICYCLE, ACCELERATIONS),
    "differential drive": (
        Dynamics.DIFFERENTIAL_DRIVE,
        ACCELERATIONS | {"track_width": 0.4, "max_wheel_speed": 2.0},
    ),
    "Ackermann": (
        Dynamics.ACKERMANN,
        {"max_acceleration": 2.0, "max_deceleration": 4.0, "wheelbase": 0.4,
         "max_steering_angle": 0.6, "max_steering_rate": 2.0},
    ),
}  # fmt: skip


def pairs() -> list[Pair]:
    """Return a pair for each kind of body, against the unicycle."""
    return [
        Pair(
            name=f"step of 512 × 4 agents, {name}", unit="agent-steps/s", peer="unicycle",
            ours=partial(rate, name), theirs=partial(rate, "unicycle"), wanted=WANTED,
        )
        for name in BODIES if name != "unicycle"
    ]  # fmt: skip


def with_body(world: World, name: str) -> World:
    """Return the same world with other bodies."""
    dynamics, limits = BODIES[name]
    count = len(world.agents)
    columns = {limit: np.full(count, value) for limit, value in limits.items()}
    kinds = np.full(count, int(dynamics), np.int8)
    return replace(world, agents=replace(world.agents, dynamics=kinds, **columns))


def rate(name: str) -> float:
    """Return agent-steps per second of the step alone."""
    simulation = Simulation([with_body(drawn()[k % DRAWN], name) for k in range(WORLDS)])
    rng = np.random.default_rng(0)
    shape = (simulation.B, simulation.A)
    twist, seconds, steps = np.ones(shape, np.bool_), 0.0, 0
    for _ in range(STEPS):
        command = np.stack([rng.uniform(0.0, 2.0, shape), rng.normal(0.0, 1.0, shape)], axis=-1)
        steps += int(((simulation.status == 0) & simulation.present).sum())
        began = perf_counter()
        simulation.step(command, twist)
        seconds += perf_counter() - began
    return steps / seconds
