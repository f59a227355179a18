"""Readings of earlier decisions."""

from dataclasses import fields

import numpy as np

from benchnav.arrays import AnyArray, BoolArray, IntArray
from benchnav.kernels import kernel_without_allocation
from benchnav.sensors.readings import Edges, Neighbours, Rays

Readings = Rays | Neighbours | Edges


class Delay:
    """Holds the readings of the last decisions, and returns late ones.

    Args:
        decisions: by how many the readings are late; 0: they are not.
    """

    def __init__(self, decisions: int) -> None:
        self._decisions = decisions
        self._kept: dict[tuple[type, str], AnyArray] = {}  # (decisions + 1, B, An, bytes)

    def exchange(self, readings: Readings, active: BoolArray, step: IntArray) -> None:
        """Keep the new readings of ``active`` (B, An) agents, and replace them by the late ones.

        ``step`` (B,) are the decisions done. In the first decisions, those of the start are given.
        """
        if self._decisions == 0 or active.size == 0:
            return
        for part in fields(readings):
            if part.name == "angle":
                continue
            values = getattr(readings, part.name).view(np.uint8).reshape(*active.shape, -1)
            name = (type(readings), part.name)
            if name not in self._kept:
                self._kept[name] = np.zeros((self._decisions + 1, *values.shape), np.uint8)
            exchange(0, len(active), active, step, self._kept[name], values)


@kernel_without_allocation
def exchange(
    low: int, high: int, active: BoolArray, step: IntArray, kept: AnyArray, values: AnyArray
) -> None:
    """Exchange the ``values`` (B, An, W) of rows low:high with those ``kept`` (N, B, An, W)."""
    size = len(kept)
    for b in range(low, high):
        now, then = step[b] % size, max(step[b] - size + 1, 0) % size
        for k in range(active.shape[1]):
            if active[b, k]:
                for w in range(values.shape[2]):
                    kept[now, b, k, w] = values[b, k, w]
                    values[b, k, w] = kept[then, b, k, w]
