"""In which call of a navigator a worker is: written by the worker, read by who watches it.

A call counts up twice, at its begin and its end: while it lasts the count is odd and
does not change. No clock is shared, so a machine that slept and processes that were
stopped together make no call look long. Whoever reads believes nothing: a navigator can
write here too.
"""

import math
import os
from collections.abc import Iterator, MutableSequence
from contextlib import contextmanager
from typing import Literal

Call = Literal["__init__", "reset", "act", "remarks"]
Notes = MutableSequence[float]  # count, which call, time in the episode [s], returned twice

SIZE = 4
_CALLS: tuple[Call, ...] = ("__init__", "reset", "act", "remarks")
_TICK = 1.0  # [s] at most between two looks: a watcher that was away longer saw nothing

_notes: list[Notes] = [[0.0] * SIZE]
_process = [0]  # that writes them; 0: any, where nobody watches


def write_to(notes: Notes, process: int = 0) -> None:
    """From now on the calls of this process are noted there."""
    _notes[0], _process[0] = notes, process


@contextmanager
def calling(call: Call, time: float = 0.0) -> Iterator[None]:
    """A navigator is called; ``time`` [s] is that of the episode in ``act``.

    Where the call forked and returns a second time, the second process ends here.
    """
    notes = _notes[0]
    notes[1], notes[2] = _CALLS.index(call), time
    notes[0] += 1
    try:
        yield
    finally:
        if _process[0] not in (0, os.getpid()):
            notes[3] = 1.0
            os._exit(1)
        notes[0] += 1


def beat() -> None:
    """Say that work outside of calls goes on."""
    if _notes[0][0]:
        _notes[0][0] += 2


class Watch:
    """Looks at the notes of one worker."""

    def __init__(self, notes: Notes) -> None:
        self.notes = notes
        self.lasted = 0.0  # [s] that its present call was seen to last
        self.idle = 0.0  # [s] that nothing was seen to happen outside of calls
        self._count = 0.0

    @property
    def called(self) -> bool:
        """Whether code of a navigator may have run in it."""
        return self.notes[0] != 0.0

    @property
    def twice(self) -> bool:
        """Whether a call returned in a second process."""
        return self.notes[3] != 0.0

    def look(self, elapsed: float) -> None:
        """Look again, ``elapsed`` [s] after the last time."""
        count = self.notes[0]
        same, odd = count == self._count and count != 0.0, count % 2 == 1
        seen = min(elapsed, _TICK)
        self.lasted = self.lasted + seen if same and odd else 0.0
        self.idle = self.idle + seen if same and not odd else 0.0
        self._count = count

    def rest(self) -> None:
        """It has nothing to do."""
        self.idle = 0.0

    def call(self) -> str:
        """Its last call in words: ``act at t = 0.6 s``."""
        which, time = self.notes[1], self.notes[2]
        call = _CALLS[int(which)] if which in range(len(_CALLS)) else "a call"
        return f"{call} at t = {time:g} s" if call == "act" and math.isfinite(time) else call
