"""Arrays of a navigator with an entry for each row (world) and agent."""

import numpy as np

from benchnav.arrays import AnyArray, IntArray


class RowTable:
    """Named arrays (rows, A, …) that grow as `reset` names rows; unset entries are zero.

    >>> table = RowTable()
    >>> table.put(2, speed=np.array([1.0, 1.5]))
    >>> table.take("speed", np.array([2]), 3).tolist()
    [[1.0, 1.5, 0.0]]
    """

    def __init__(self) -> None:
        self._arrays: dict[str, AnyArray] = {}

    def put(self, row: int, **values: AnyArray) -> None:
        """Replace the entries of ``row``; each value starts with the agents' axis (A, …)."""
        for name, value in values.items():
            array = self._grown(name, row + 1, value)
            array[row] = 0
            array[row, : len(value)] = value

    def take(self, name: str, rows: IntArray, agents: int) -> AnyArray:
        """Return the entries (B, agents, …) of rows (B,), cut or zero-padded to ``agents``."""
        array = self._arrays[name]
        taken = array[rows, :agents]
        missing = agents - taken.shape[1]
        if missing > 0:
            widths = [(0, 0), (0, missing)] + [(0, 0)] * (taken.ndim - 2)
            taken = np.pad(taken, widths)
        return taken

    def write(self, name: str, rows: IntArray, values: AnyArray) -> None:
        """Replace the entries ``name`` of the rows (B,) by ``values`` (B, agents, …)."""
        array = self._arrays[name]
        kept = min(array.shape[1], values.shape[1])
        array[rows, :kept] = values[:, :kept]

    def _grown(self, name: str, rows: int, value: AnyArray) -> AnyArray:
        old = self._arrays.get(name)
        if old is not None and old.shape[0] >= rows and old.shape[1] >= len(value):
            return old
        height, width = (0, 0) if old is None else old.shape[:2]
        capacity = height if height >= rows else max(rows, 2 * height)
        new = np.zeros((capacity, max(width, len(value)), *value.shape[1:]), value.dtype)
        if old is not None:
            new[:height, :width] = old
        self._arrays[name] = new
        return new
