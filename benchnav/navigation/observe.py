"""The one place where an `Observation` is assembled: for runs, for training and for tests.

A navigator is trained and evaluated on the same arrays because the runner, the environments and
the checks of navigators all call `observe`.
"""

from collections.abc import Sequence

import numpy as np

from benchnav.arrays import BoolArray, IntArray
from benchnav.navigation.map import Map
from benchnav.navigation.observation import Observation
from benchnav.sensors.noise.noisy_senses import NoisySenses
from benchnav.sensors.own_state import copy_own_state, find_deciding
from benchnav.sensors.sense import sense
from benchnav.world.simulation import Simulation


def deciding(simulation: Simulation, agents: IntArray) -> BoolArray:
    """Return (B, An), True where an agent decides now.

    Args:
        simulation: B worlds.
        agents: (B, An) indices of agents; -1 is padding, which never decides.
    """
    active = np.empty(agents.shape, np.bool_)
    chosen = np.array(agents, np.int64)  # one type of array, so that kernels compile once
    find_deciding(0, simulation.B, chosen, simulation.records, simulation.agents, active)
    return active


def observe(
    simulation: Simulation,
    agents: IntArray,
    active: BoolArray,
    needs: frozenset[str],
    maps: Sequence[Map | None],
    senses: NoisySenses | None = None,
) -> Observation:
    """Return what some agents perceive now. Its arrays are copies, and zero for padding.

    Args:
        simulation: B worlds with one sensing.
        agents: (B, An) indices of the observing agents; -1 is padding.
        active: (B, An) which of them sense and decide; copied.
        needs: the sensors to compute; the others are None.
        maps: (B,) the map that each world's agents hold now.
        senses: the noise of the senses of these agents; None: they perceive without error.

    `rows` numbers the worlds of the simulation from 0.
    """
    shape = agents.shape
    position, velocity, goal = np.empty((*shape, 2)), np.empty((*shape, 2)), np.empty((*shape, 2))
    heading, steering = np.empty(shape), np.empty(shape)
    rows, time = np.empty(len(agents), np.int64), np.empty(len(agents))
    sensing = np.empty(shape, np.int64)
    copy_own_state(
        0, simulation.B, np.ascontiguousarray(agents, np.int64), np.ascontiguousarray(active),
        simulation.records, simulation.agents, simulation.limits, rows, time, sensing, position,
        heading, velocity, goal, steering,
    )  # fmt: skip
    if senses is None:
        rays, neighbours, edges = sense(simulation, sensing, needs)
    else:
        rays, neighbours, edges = senses.sense(active, needs)
        senses.localise(position, heading, velocity)
    return Observation(
        rows=rows,
        time=time,
        active=active.copy(),
        position=position,
        heading=heading,
        velocity=velocity,
        goal=goal,
        steering=steering,
        maps=tuple(maps),
        rays=rays,
        neighbours=neighbours,
        edges=edges,
    )
