"""Noise: an observation of noisy senses, and an exact one.

The worlds are those of `leader_arena`, and so is the driving. Rays, neighbours, edges and the own
state are sensed, with the default noise of scenarios; the step is not timed.
"""

from functools import partial
from time import perf_counter

import numpy as np

from benchmarks.leader_arena import DRAWN, drawn
from benchmarks.pair import Pair
from benchnav.generation.build import noise_of
from benchnav.navigation.observe import observe
from benchnav.scenario.catalogue import find
from benchnav.sensors.noise.noisy_senses import NoisySenses
from benchnav.world.simulation import Simulation

WORLDS, STEPS = 512, 25
WANTED = 0.5  # of the speed of exact observations
SENSORS = frozenset({"rays", "neighbours", "edges"})


def pairs() -> list[Pair]:
    """Return the pair of noisy and exact observations."""
    return [
        Pair(
            name="noisy observations of 512 × 4 agents, all sensors", unit="observations/s",
            peer="exact observations", ours=partial(rate, noisy=True),
            theirs=partial(rate, noisy=False), wanted=WANTED,
        )
    ]  # fmt: skip


def rate(noisy: bool) -> float:
    """Return observations of agents per second."""
    simulation = Simulation([drawn()[k % DRAWN] for k in range(WORLDS)])
    chosen = np.tile(np.arange(simulation.A), (simulation.B, 1))
    senses = None
    if noisy:
        senses = NoisySenses(simulation, chosen, noise_of(find("leaders/dynamic")))
        rows = np.arange(simulation.B)
        senses.begin(rows, np.stack([rows, rows], axis=1).astype(np.uint64))
    rng, maps = np.random.default_rng(0), (None,) * simulation.B
    twist, seconds, count = np.ones(chosen.shape, np.bool_), 0.0, 0
    for _ in range(STEPS):
        active = (simulation.status == 0) & simulation.present
        began = perf_counter()
        observe(simulation, chosen, active, SENSORS, maps, senses)
        seconds += perf_counter() - began
        count += int(active.sum())
        speed, turn = rng.uniform(0.0, 2.0, chosen.shape), rng.normal(0.0, 1.0, chosen.shape)
        simulation.step(np.stack([speed, turn], axis=-1), twist)
    return count / seconds
