"""The senses of some agents in the perception track `noisy`."""

import numpy as np

from benchnav.arena.noise import Noise
from benchnav.arrays import AnyArray, BoolArray, FloatArray, IntArray
from benchnav.sensors.readings import Edges, Neighbours, Rays
from benchnav.sensors.sense import sense
from benchnav.world.simulation import Simulation


class NoisySenses:
    """The noise of the senses of the agents ``chosen`` (B, An) of a simulation, and its memory.

    Args:
        simulation: B worlds with one sensing.
        chosen: (B, An) indices of agents, -1: padding. The live array of the caller.
        noise: the errors.
    """

    def __init__(self, simulation: Simulation, chosen: IntArray, noise: Noise) -> None:
        self._simulation = simulation
        self._chosen = chosen
        self.noise = noise

    def begin(self, rows: IntArray, keys: AnyArray) -> None:
        """Start the worlds in ``rows`` (N,) with the noise of ``keys`` (N, 2) of uint64."""

    def sense(
        self, active: BoolArray, needs: frozenset[str]
    ) -> tuple[Rays | None, Neighbours | None, Edges | None]:
        """Return the readings of the agents that are ``active`` (B, An); blank for others."""
        return sense(self._simulation, np.where(active, self._chosen, -1), needs)

    def localise(self, position: FloatArray, heading: FloatArray, velocity: FloatArray) -> None:
        """Replace true own states (B, An, …) by their estimates."""

    def in_world_frame(self, rows: IntArray, velocity: FloatArray) -> FloatArray:
        """Return planar velocities (N, An, 2) [m/s] of the worlds ``rows``, turned by the error."""
        return velocity
