"""The one place where an `Observation` is assembled: for runs, for training and for tests.

A navigator is trained and evaluated on the same arrays because the runner, the environments and
the checks of navigators all call `observe`.
"""

from collections.abc import Sequence

import numpy as np

from benchnav.arrays import BoolArray, FloatArray, IntArray
from benchnav.episode.episode import Status
from benchnav.navigation.map import Map
from benchnav.navigation.observation import Observation
from benchnav.sensors.sense import sense
from benchnav.world.simulation import Simulation


def deciding(simulation: Simulation, agents: IntArray) -> BoolArray:
    """Return (B, An), True where an agent decides now.

    Args:
        simulation: B worlds.
        agents: (B, An) indices of agents; -1 is padding, which never decides.
    """
    at = np.arange(simulation.B)[:, None], agents
    active: BoolArray = (agents >= 0) & simulation.running[:, None] & simulation.present[at]
    active &= simulation.status[at] == int(Status.ACTIVE)
    return active


def observe(
    simulation: Simulation,
    agents: IntArray,
    active: BoolArray,
    needs: frozenset[str],
    maps: Sequence[Map | None],
) -> Observation:
    """Return what some agents perceive now. Its arrays are copies, and zero for padding.

    Args:
        simulation: B worlds with one sensing.
        agents: (B, An) indices of the observing agents; -1 is padding.
        active: (B, An) which of them sense and decide; copied.
        needs: the sensors to compute; the others are None.
        maps: (B,) the map that each world's agents hold now.

    `rows` numbers the worlds of the simulation from 0.
    """
    at = np.arange(simulation.B)[:, None], agents
    rays, neighbours, edges = sense(simulation, np.where(active, agents, -1), needs)
    padding = agents < 0

    def own(array: FloatArray) -> FloatArray:
        values = array[at]
        values[padding] = 0.0
        return values

    return Observation(
        rows=np.arange(simulation.B),
        time=simulation.steps_done * simulation.records["dt"],
        active=active.copy(),
        position=own(simulation.position),
        heading=own(simulation.heading),
        velocity=own(simulation.velocity),
        goal=own(simulation.goal),
        maps=tuple(maps),
        rays=rays,
        neighbours=neighbours,
        edges=edges,
    )
