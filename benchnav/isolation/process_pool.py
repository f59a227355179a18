"""The processes of isolated navigators that this process keeps alive between batches.

A process serves the batches of one job only: what it received in one track or scenario never
reaches another entry or track.
"""

from collections import OrderedDict
from collections.abc import Callable, Hashable

from benchnav.isolation.navigator_process import Process

MAX_KEPT = 2  # a navigator, and the leader of its rehearsals
_KEPT: OrderedDict[Hashable, Process] = OrderedDict()


def acquire(key: Hashable, start: Callable[[], Process]) -> Process:
    """Return the process of job ``key``; start a new one if there is none or it died."""
    kept = _KEPT.pop(key, None)
    process = kept if kept is not None and kept.alive else start()
    _KEPT[key] = process
    while len(_KEPT) > MAX_KEPT:
        _KEPT.popitem(last=False)[1].stop()
    return process


def stop_all() -> None:
    """Stop all processes."""
    while _KEPT:
        _KEPT.popitem()[1].stop()


def peak_memory() -> int:
    """Return the largest memory [bytes] that one of the processes held in RAM."""
    return max((process.peak_memory() for process in _KEPT.values()), default=0)
