"""How long the tasks that are left take, learned from those that are finished."""

from collections import defaultdict
from collections.abc import Callable, Hashable
from dataclasses import dataclass
from time import monotonic

KNOWN = 0.9  # share of the effort that is left whose speed must be known


@dataclass(frozen=True)
class Load:
    """A task, as far as its time is concerned."""

    navigator: str  # tasks of one take about the same time for the same effort
    effort: float  # `benchnav.runner.plan.job.Cell.effort` of all its episodes: no seconds


class Estimate:
    """Learns how many seconds an effort takes each navigator, from its last finished task.

    The last one is most like the next one, for the longest are begun first. The first task of
    a worker also compiles and loads: its time tells nothing of others.
    """

    def __init__(self, clock: Callable[[], float] = monotonic) -> None:
        self._clock = clock
        self._pending: defaultdict[str, float] = defaultdict(float)  # navigator → effort
        self._running: dict[Hashable, tuple[Load, float]] = {}  # worker → task, begun [s]
        self._warm: set[Hashable] = set()
        self._pace: dict[str, float] = {}  # navigator → [s] of an effort
        self._workers = 1

    def expect(self, load: Load) -> None:
        """A task that is to be run."""
        self._pending[load.navigator] += load.effort

    def start(self, worker: Hashable, load: Load) -> None:
        """A worker begins one that was expected."""
        self._pending[load.navigator] -= load.effort
        self._running[worker] = load, self._clock()
        self._workers = max(self._workers, len(self._running))

    def finish(self, worker: Hashable) -> None:
        """It is done."""
        load, since = self._running.pop(worker)
        if worker in self._warm:
            self._pace[load.navigator] = (self._clock() - since) / load.effort
        self._warm.add(worker)

    def drop(self, worker: Hashable) -> None:
        """The worker is gone; what it ran is to be run again."""
        if worker in self._running:
            self.expect(self._running.pop(worker)[0])

    def left(self) -> float | None:
        """[s] until all is done; None where too little is known to tell within a factor of two."""
        now, known, effort, seconds = self._clock(), 0.0, 0.0, 0.0
        longest = 0.0  # [s] that a running task lasts on
        running = [(load, now - since) for load, since in self._running.values()]
        pending = [(Load(*item), 0.0) for item in self._pending.items()]
        for load, spent in (*running, *pending):
            effort += load.effort
            pace = self._pace.get(load.navigator)
            if pace is not None:
                known += load.effort
                rest = max(load.effort * pace - spent, 0.0)
                seconds += rest
                longest = max(longest, rest if spent else 0.0)
        if not known or known < KNOWN * effort:
            return None
        return max(seconds / self._workers * effort / known, longest)
