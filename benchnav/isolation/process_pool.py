"""The processes that this process keeps for isolated navigators, so that they stay warm.

One serves all batches of one cell, and no other: what it was told in one track, or in
another scenario, never reaches another entry or track.
"""

from collections import OrderedDict
from collections.abc import Callable, Hashable

from benchnav.isolation.navigator_process import Process

MOST = 2  # kept: of a navigator, and of who leads in its rehearsals
_KEPT: OrderedDict[Hashable, Process] = OrderedDict()


def lend(cell: Hashable, start: Callable[[], Process]) -> Process:
    """The process of ``cell``; a new one where there is none, or where it died."""
    kept = _KEPT.pop(cell, None)
    process = kept if kept is not None and kept.alive else start()
    _KEPT[cell] = process
    while len(_KEPT) > MOST:
        _KEPT.popitem(last=False)[1].stop()
    return process


def dismiss() -> None:
    """End them all."""
    while _KEPT:
        _KEPT.popitem()[1].stop()


def peak_memory() -> int:
    """[bytes] the most that one of them held in RAM."""
    return max((process.peak_memory() for process in _KEPT.values()), default=0)
