"""Synthetic rehearsals, without a simulation, for navigators that request rehearsals."""

import math

import numpy as np

from benchnav.arena.world import World
from benchnav.generation.rehearsal_world import leaders_of
from benchnav.navigation.rehearsal import Rehearsal

STEPS = 40


def rehearsals_of(world: World, count: int) -> tuple[Rehearsal, ...]:
    """Return ``count`` rehearsals in which every leader goes to its goal in an arc.

    The arcs differ; in the first all leaders collide, in the second none arrives.
    """
    leaders, agents = leaders_of(world.agents), world.agents
    start, goal = agents.start[leaders], agents.goal[leaders]
    share = np.linspace(0.0, 1.0, STEPS + 1)[:, None, None]
    across = np.stack([start[:, 1] - goal[:, 1], goal[:, 0] - start[:, 0]], axis=1)
    rehearsals = []
    for k in range(count):
        bow = 0.3 * math.sin(1.0 + k) * np.sin(math.pi * share)
        arrives = STEPS * world.clock.dt * (1.0 + 0.1 * k) if k != 1 else math.nan
        rehearsals.append(
            Rehearsal(
                world.clock.dt,
                leaders.copy(),
                start + share * (goal - start) + bow * across,
                np.full(len(leaders), STEPS),
                np.full(len(leaders), arrives),
                np.full(len(leaders), k == 0),
            )
        )
    return tuple(rehearsals)
