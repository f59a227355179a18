"""In which call of a navigator a worker is: written by the worker, read by who watches it.

A call counts up twice, at its begin and its end: while it lasts the count is odd and
does not change. No clock is shared, so a machine that slept and processes that were
stopped together make no call look long.
"""

from collections.abc import Iterator, MutableSequence
from contextlib import contextmanager
from typing import Literal

Call = Literal["__init__", "reset", "act", "remarks"]
Notes = MutableSequence[float]  # count, which call, time in the episode [s]

SIZE = 3
_CALLS: tuple[Call, ...] = ("__init__", "reset", "act", "remarks")
_TICK = 1.0  # [s] at most between two looks: a watcher that was away longer saw nothing

_notes: list[Notes] = [[0.0] * SIZE]


def write_to(notes: Notes) -> None:
    """From now on the calls of this process are noted there."""
    _notes[0] = notes


@contextmanager
def calling(call: Call, time: float = 0.0) -> Iterator[None]:
    """A navigator is called; ``time`` [s] is that of the episode in ``act``."""
    notes = _notes[0]
    notes[1], notes[2] = _CALLS.index(call), time
    notes[0] += 1
    try:
        yield
    finally:
        notes[0] += 1


class Watch:
    """Looks at the notes of one worker."""

    def __init__(self, notes: Notes) -> None:
        self.notes = notes
        self.lasted = 0.0  # [s] that its present call was seen to last
        self._count = 0.0

    def look(self, elapsed: float) -> None:
        """Look again, ``elapsed`` [s] after the last time."""
        count = self.notes[0]
        same = count == self._count and count % 2 == 1
        self.lasted = self.lasted + min(elapsed, _TICK) if same else 0.0
        self._count = count

    def call(self) -> str:
        """Its last call in words: ``act at t = 0.6 s``."""
        call = _CALLS[int(self.notes[1])]
        return f"{call} at t = {self.notes[2]:g} s" if call == "act" else call
