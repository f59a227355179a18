"""The unit of work: one cell for a range of seeds."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from benchnav.episode.episode import Episode
from benchnav.errors import MissingExtraError
from benchnav.isolation import fence
from benchnav.metrics.measure import all_metrics
from benchnav.navigation.answer import kind_of
from benchnav.runner.cell import Cell
from benchnav.runner.estimate import Load
from benchnav.runner.latency import latency, peak_memory
from benchnav.runner.measured import failed_metrics, measured, tracebacks_of
from benchnav.runner.rehearsal import Performance, perform
from benchnav.runner.rollout import Assignment, Seeded
from benchnav.store.part import Part
from benchnav.store.part_writer import PartWriter
from benchnav.world.build import build

CHUNK = 64  # seeds of a task: enough for lockstep to pay, few enough to lose to an interruption
EFFORT = 4_000_000  # agent-decisions of a task, as far as a cell can tell beforehand


@dataclass(frozen=True)
class Task:
    """Runs seeds first … stop - 1 of a cell and stores them as one part."""

    cell: Cell
    folder: Path  # of the cell
    first: int
    stop: int
    charge: str = ""  # a reason for which every episode fails without running
    salt: str = ""  # of the run
    probe: int = -1  # seed in whose world latency is taken; one for each cell

    @property
    def assignment(self) -> Assignment:
        """Who runs where, in this run."""
        return replace(self.cell.assignment, salt=self.salt)

    @property
    def seeds(self) -> range:
        """What it runs."""
        return range(self.first, self.stop)

    @property
    def load(self) -> Load:
        """For the estimate of the time that is left."""
        return Load(self.cell.entry.label, self.cell.effort * len(self.seeds))

    def alone(self) -> list["Task"]:
        """The same, seed by seed."""
        return [replace(self, first=seed, stop=seed + 1) for seed in self.seeds]


@dataclass(frozen=True)
class Outcome:
    """What there is to say about a finished task."""

    episodes: int
    redraws: int  # draws of worlds that were thrown away as unsolvable
    failures: tuple[tuple[int, str], ...] = field(default=())  # (seed, reason)
    unled: tuple[tuple[int, str], ...] = field(
        default=()
    )  # (seed, team): its leader never succeeded
    remarks: tuple[tuple[int, str], ...] = field(default=())  # (seed, what the navigator tells)
    missing: tuple[tuple[str, str], ...] = field(default=())  # (metric, how it failed), by value
    lacks: str = ""  # what is not installed, and how to: then nothing was stored
    tracebacks: Mapping[str, str] = field(default_factory=dict)  # by kind of reason, of one each


def chunks(seeds: Iterable[int], effort: float) -> Iterator[tuple[int, int]]:
    """Ranges (first, stop) that cover ``seeds``, each of which costs ``effort``."""
    size = max(1, min(CHUNK, int(EFFORT / max(effort, 1.0))))
    run: list[int] = []
    for seed in sorted(seeds):
        if run and (seed != run[-1] + 1 or len(run) == size):
            yield run[0], run[-1] + 1
            run = []
        run.append(seed)
    if run:
        yield run[0], run[-1] + 1


def work(task: Task, tick: Callable[[int], None] = lambda _: None) -> Outcome:
    """Run a task; its part is on disk when this returns, unless an extra lacks.

    Args:
        task: what to run.
        tick: called with the number of episodes that were just finished.

    Raises:
        UnsolvableError: the scenario cannot be drawn.
        StoreError: the disk refuses.
    """
    try:
        return _work(task, tick)
    except MissingExtraError as error:
        return Outcome(0, 0, lacks=str(error))


def _work(task: Task, tick: Callable[[int], None]) -> Outcome:
    cell = task.cell
    if task.assignment.isolated:
        fence.hide()  # before there is anything to hide
    worlds = [(seed, build(cell.scenario, cell.split, seed)) for seed in task.seeds]
    metrics = all_metrics()
    failures: list[tuple[int, str]] = []
    unled: list[tuple[int, str]] = []
    remarks: list[tuple[int, str]] = []
    missing: list[tuple[str, str]] = []
    tracebacks: dict[str, str] = {}
    with PartWriter(Part(task.folder, task.first, task.stop)) as writer:
        for batch in perform(task.assignment, worlds, task.charge):
            episodes = _timed(task, batch)
            rehearsals = [e for performance in batch for e in performance.rehearsed.episodes]
            results = measured(_ticking(episodes, tick), metrics)
            writer.add(episodes, results, rehearsals)
            missing += failed_metrics(results)
            tracebacks |= {kind_of(e.failure): e.traceback for e in episodes if e.traceback}
            tracebacks |= tracebacks_of(results)
            failures += [(e.identity.seed, e.failure) for e in episodes if e.failure]
            remarks += [(e.identity.seed, text) for e in episodes for text in e.remarks]
            unled += [(p.episode.identity.seed, team) for p in batch for team in p.unled]
        writer.seal()
    redraws = sum(world.redraws for _, world in worlds)
    failed, alone, said = (tuple(sorted(found)) for found in (failures, unled, remarks))
    return Outcome(
        len(worlds), redraws, failed, alone, said, tuple(missing), tracebacks=tracebacks
    )  # fmt: skip


def _timed(task: Task, batch: list[Performance]) -> list[Episode]:
    """The episodes with peak memory, and with latency where it is to be taken."""
    timed = []
    for performance in batch:
        episode, grant = performance.episode, tuple(performance.rehearsed.grant)
        seeded: Seeded = (episode.identity.seed, episode.world)
        wanted = seeded[0] == task.probe and not episode.failure
        alone = latency(task.assignment, seeded, grant) if wanted else None
        timings = replace(episode.timings, latency=alone, memory=peak_memory())
        timed.append(replace(episode, timings=timings))
    return timed


def _ticking(episodes: Sequence[Episode], tick: Callable[[int], None]) -> Iterator[Episode]:
    for episode in episodes:
        yield episode
        tick(1)
