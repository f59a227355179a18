"""How long the current call of a navigator has lasted: the worker counts, the parent measures.

The worker increments a counter in shared memory at the begin and at the end of every call, so
that it is odd and constant during a call. The parent measures how long it stays constant. No
clock is shared: a suspended machine makes no call look long. A navigator can write to the
shared memory too, so the parent trusts no value in it.
"""

import math
import os
from collections.abc import Iterator, MutableSequence
from contextlib import contextmanager
from typing import Literal

Call = Literal["__init__", "reset", "act", "remarks"]
Notes = MutableSequence[float]
"""Counter, kind of call, time in the episode [s], returned twice, number of the drawn world."""

SIZE = 5
_CALLS: tuple[Call, ...] = ("__init__", "reset", "act", "remarks")
_MAX_INTERVAL = 1.0  # [s] that one check may add: a longer gap means the parent was suspended

_notes: list[Notes] = [[0.0] * SIZE]
_process = [0]  # the process that may write; 0: any, if no parent reads


def write_to(notes: Notes, process: int = 0) -> None:
    """Count the calls of this process in ``notes`` from now on."""
    _notes[0], _process[0] = notes, process


@contextmanager
def calling(call: Call, time: float = 0.0) -> Iterator[None]:
    """Count a call of a navigator; ``time`` [s] is the time in the episode, for ``act``.

    If the call forked and returns in the child process as well, the child ends here.
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
    """Count progress outside of calls."""
    if _notes[0][0]:
        _notes[0][0] += 2


def note_drawing(number: int) -> None:
    """Note which world of the task is drawn now, counted from 1; 0: none."""
    _notes[0][4] = number
    beat()


class CallTimer:
    """Measures the calls of one worker."""

    def __init__(self, notes: Notes) -> None:
        self.notes = notes
        self.lasted = 0.0  # [s] since the current call began
        self.idle = 0.0  # [s] without progress outside of calls
        self._count = 0.0

    @property
    def called(self) -> bool:
        """Whether code of a navigator may have run in the worker."""
        return self.notes[0] != 0.0

    @property
    def twice(self) -> bool:
        """Whether a call returned in a second process."""
        return self.notes[3] != 0.0

    @property
    def drawing(self) -> float:
        """The number of the world that is drawn, from 1; 0: none."""
        return self.notes[4]

    @property
    def episode_time(self) -> float | None:
        """The time in the episode [s] of the last call if it was ``act``, else None."""
        which, time = self.notes[1], self.notes[2]
        return time if which == _CALLS.index("act") and 0.0 <= time < math.inf else None

    @property
    def has_played(self) -> bool:
        """Whether the last call was ``remarks``, which follows the last decision."""
        return self.notes[1] == _CALLS.index("remarks")

    def look(self, elapsed: float) -> None:
        """Read the counter, ``elapsed`` [s] after the last time."""
        count = self.notes[0]
        same, odd = count == self._count and count != 0.0, count % 2 == 1
        seen = min(elapsed, _MAX_INTERVAL)
        self.lasted = self.lasted + seen if same and odd else 0.0
        self.idle = self.idle + seen if same and not odd else 0.0
        self._count = count

    def rest(self) -> None:
        """Reset the idle time: the worker has no task."""
        self.idle = 0.0

    def call(self) -> str:
        """Return the last call as text, such as ``act at t = 0.6 s``."""
        which, time = self.notes[1], self.notes[2]
        call = _CALLS[int(which)] if which in range(len(_CALLS)) else "a call"
        return f"{call} at t = {time:g} s" if call == "act" and math.isfinite(time) else call
