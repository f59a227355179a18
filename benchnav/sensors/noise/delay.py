"""Readings of earlier decisions."""

from dataclasses import fields

import numpy as np

from benchnav.arrays import AnyArray, BoolArray, IntArray
from benchnav.sensors.readings import Edges, Neighbours, Rays

Readings = Rays | Neighbours | Edges


class Delay:
    """Holds the readings of the last decisions, and returns late ones.

    Args:
        decisions: by how many the readings are late; 0: they are not.
    """

    def __init__(self, decisions: int) -> None:
        self._decisions = decisions
        self._kept: dict[tuple[type, str], AnyArray] = {}  # (decisions + 1, B, An, …)

    def exchange(self, readings: Readings, active: BoolArray, step: IntArray) -> None:
        """Keep the new readings of ``active`` (B, An) agents, and replace them by the late ones.

        ``step`` (B,) are the decisions done. In the first decisions, those of the start are given.
        """
        if self._decisions == 0:
            return
        size = self._decisions + 1
        b, k = np.nonzero(active)
        now, then = step[b] % size, np.maximum(step[b] - self._decisions, 0) % size
        for part in fields(readings):
            values = getattr(readings, part.name)
            if part.name == "angle":
                continue
            name = (type(readings), part.name)
            if name not in self._kept:
                self._kept[name] = np.zeros((size, *values.shape), values.dtype)
            kept = self._kept[name]
            kept[now, b, k] = values[b, k]
            values[b, k] = kept[then, b, k]
