"""A batch of worlds in which a finished row starts again with another world of a pool."""

from collections.abc import Sequence

import numpy as np

from benchnav.arena.solid import Kind
from benchnav.arena.world import World
from benchnav.arrays import IntArray
from benchnav.world.simulation import Simulation, partners

KINDS = len(Kind)


class AutoresetSimulation(Simulation):
    """B rows over a pool of W worlds that share clock, rules and sensing.

    Walls, shapes and motion laws never change and are prepared once for the whole pool; a
    restart copies a few records.
    """

    def __init__(self, pool: Sequence[World], rows: int) -> None:
        super().__init__(pool)
        self.pool = self.worlds
        self._fresh = (self.agents, self.limits, self.bodies, self.records, self.sees)
        first = np.arange(rows) % len(pool)
        self.worlds = tuple(self.pool[w] for w in first)
        live = (array[first] for array in self._fresh)
        self.agents, self.limits, self.bodies, self.records, self.sees = live
        self._opened, self._closed = self._opened[first], self._closed[first]
        self._kept = [[] for _ in first]
        self.hashed, self.spots = self.hashed[first], self.spots[first]
        self.near = self.near[first]
        self.listed, self.beyond = self.listed[first], self.beyond[first]
        self._views()

    def restart(self, rows: IntArray, worlds: IntArray) -> None:
        """Start the worlds ``worlds`` (N,) of the pool in ``rows`` (N,)."""
        arrays = (self.agents, self.limits, self.bodies, self.records, self.sees)
        for live, fresh in zip(arrays, self._fresh, strict=True):
            live[rows] = fresh[worlds]
        self._opened["code"][rows] = -1
        held = list(self.worlds)
        for b, w in zip(rows.tolist(), worlds.tolist(), strict=True):
            held[b] = self.pool[w]
            self._kept[b] = []
        self.worlds = tuple(held)

    def begun(self) -> IntArray:
        """Return numbers (B, A, KINDS) of charged events that began in the last step, by kind."""
        counts = np.zeros((self.B, self.A, KINDS), np.int64)
        since = (self.records["steps_done"] - 1) * self.records["dt"] - 1e-9  # rounding
        going = (self._opened["code"] >= 0) & (self._opened["start"] >= since[:, None, None])
        listed = np.arange(self._closed.shape[1]) < self.records["closed"][:, None]
        closed = listed & (self._closed["start"] >= since[:, None])
        for b in np.flatnonzero(going.any((1, 2)) | closed.any(1)):
            agent, slot = np.nonzero(going[b])
            rows = self._opened[b, agent, slot]
            rows["agent"] = agent
            rows = np.concatenate([rows, self._closed[b, closed[b]]])
            rows = rows[rows["charged"]]
            kind, _ = partners(self.worlds[b], rows["code"])
            np.add.at(counts[b], (rows["agent"], kind), 1)
        return counts
