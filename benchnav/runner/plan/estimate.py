"""The estimate of the remaining time of a run, from the durations of its finished tasks."""

from collections import defaultdict
from collections.abc import Callable, Hashable
from dataclasses import dataclass
from time import monotonic

KNOWN = 0.9  # least share of the remaining effort whose pace must be known


@dataclass(frozen=True)
class Load:
    """The properties of a task that determine its duration."""

    navigator: str  # its tasks of equal effort take about equal time
    effort: float  # of all its episodes, as `benchnav.runner.plan.job.Job.effort`; not in seconds


class Estimate:
    """Estimates the time per effort of each navigator from its last finished task.

    The longest tasks start first, so the last task is the most similar to the next one. The first
    task of a worker is ignored, because it also compiles and loads.
    """

    def __init__(self, clock: Callable[[], float] = monotonic) -> None:
        self._clock = clock
        self._pending: defaultdict[str, float] = defaultdict(float)  # navigator → effort
        self._running: dict[Hashable, tuple[Load, float]] = {}  # worker → task, begun [s]
        self._warm: set[Hashable] = set()
        self._pace: dict[str, float] = {}  # navigator → [s] per unit of effort
        self._workers = 1

    def expect(self, load: Load) -> None:
        """Add a task that will run."""
        self._pending[load.navigator] += load.effort

    def start(self, worker: Hashable, load: Load) -> None:
        """Record that a worker begins an expected task."""
        self._pending[load.navigator] -= load.effort
        self._running[worker] = load, self._clock()
        self._workers = max(self._workers, len(self._running))

    def finish(self, worker: Hashable) -> None:
        """Record that the task of a worker is finished."""
        load, since = self._running.pop(worker)
        if worker in self._warm:
            self._pace[load.navigator] = (self._clock() - since) / load.effort
        self._warm.add(worker)

    def drop(self, worker: Hashable) -> None:
        """Record that a worker ended early: its task will run again."""
        if worker in self._running:
            self.expect(self._running.pop(worker)[0])

    def left(self) -> float | None:
        """Return the remaining time [s]; None if the error could exceed a factor of two."""
        now, known, effort, seconds = self._clock(), 0.0, 0.0, 0.0
        longest = 0.0  # [s] that remain of the longest running task
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
