"""The unit of work: one cell for a range of seeds."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path

import pyarrow as pa

from benchnav.episode.episode import Episode
from benchnav.errors import MissingExtraError
from benchnav.isolation import sandbox
from benchnav.metrics.measure import all_metrics
from benchnav.navigation.command_check import kind_of, one_of_each_kind
from benchnav.plugins import Registration
from benchnav.runner.execute.call_timer import beat, note_drawing
from benchnav.runner.execute.measurement import failed_metrics, measured, tracebacks_of
from benchnav.runner.plan.estimate import Load
from benchnav.runner.plan.job import Job
from benchnav.runner.rollouts.latency import latency, peak_memory
from benchnav.runner.rollouts.rehearsal import Performance, perform
from benchnav.runner.rollouts.rollout import Assignment, Seeded
from benchnav.store.parts.part import Part, parts_of
from benchnav.store.parts.part_writer import EpisodeFiles, seal
from benchnav.store.parts.staged import check_rehearsals, staged_episodes
from benchnav.store.parts.undisturbed import UndisturbedEpisodes

Tick = Callable[[int], None]
CHUNK = 64  # seeds of a task: many for a fast lockstep, few because an interruption loses them
LARGEST = 4  # times `CHUNK`: a task of a run that has many more tasks than workers
EFFORT = 4_000_000  # agent-decisions of a task, as estimated by `Job.effort`
LIGHT = 500_000  # agent-decisions of a task of more than `CHUNK` seeds


@dataclass(frozen=True)
class Task:
    """Runs seeds first … stop - 1 of a cell and stores them as one part."""

    job: Job
    folder: Path  # of the cell
    first: int
    stop: int
    forced_failure: str = ""  # a reason for which every episode fails without running
    salt: str = ""  # of the run
    probe: int = -1  # the seed of the world in which latency is measured; one for each cell
    undisturbed: Path | None = None  # the cell with the undisturbed episodes of its worlds
    new_process: bool = False  # whether it needs a new process
    exclusive: bool = False  # whether no other task may run at the same time

    @property
    def assignment(self) -> Assignment:
        """The navigator, the scenario and the condition, with the salt of the run."""
        return replace(self.job.assignment, salt=self.salt)

    @property
    def seeds(self) -> range:
        """The seeds of the task."""
        return range(self.first, self.stop)

    @property
    def process_key(self) -> tuple[str, str]:
        """The navigator, and the scenario's drivers ("" if none), whose code a process runs."""
        job, own = self.job, self.job.contestant
        drivers = job.scenario.driver_specs
        return repr((own.label, own.hash, own.source_hash)), repr(drivers) if drivers else ""

    @property
    def load(self) -> Load:
        """Its load, for the estimate of the remaining time."""
        return Load(self.job.contestant.label, self.job.effort * len(self.seeds))

    @property
    def max_calls(self) -> int:
        """The largest possible number of calls of navigators and of built worlds."""
        job, seeds = self.job, len(self.seeds)
        drivers = 1 + len(job.scenario.driver_specs)
        passes = (1 + job.contestant.rehearsal) * seeds * (seeds.bit_length() + 2) + 1
        return drivers * passes * (job.scenario.clock.steps + 10) + 10 * seeds + 100

    def one_by_one(self) -> list["Task"]:
        """Return one task for each seed."""
        return [replace(self, first=seed, stop=seed + 1) for seed in self.seeds]


@dataclass(frozen=True)
class Outcome:
    """The outcome of a finished task."""

    episodes: int
    redraws: int  # draws of worlds that were thrown away as unsolvable
    failures: tuple[tuple[int, str], ...] = field(default=())  # (seed, reason)
    unled: tuple[tuple[int, str], ...] = field(
        default=()
    )  # (seed, team): its leader never succeeded
    remarks: tuple[tuple[int, str], ...] = field(default=())  # (seed, remark of the navigator)
    missing: tuple[tuple[str, str], ...] = field(default=())  # (metric, reason), for each value
    missing_extra: str = ""  # the missing extra, and its installation; if given, nothing was stored
    tracebacks: Mapping[str, str] = field(default_factory=dict)  # one for each kind of reason


def chunks(seeds: Iterable[int], effort: float, joined: int = 1) -> Iterator[tuple[int, int]]:
    """Yield ranges (first, stop) that cover ``seeds``.

    Args:
        seeds: of one cell.
        effort: that of one seed.
        joined: how many times `CHUNK` a range may hold, if its episodes are short.
    """
    effort = max(effort, 1.0)
    size = max(1, min(CHUNK, int(EFFORT / effort)), min(CHUNK * joined, int(LIGHT / effort)))
    run: list[int] = []
    for seed in sorted(seeds):
        if run and (seed != run[-1] + 1 or len(run) == size):
            yield run[0], run[-1] + 1
            run = []
        run.append(seed)
    if run:
        yield run[0], run[-1] + 1


def joined_chunks(seeds: int, workers: int) -> int:
    """Return how many times `CHUNK` seeds a task of a run may hold, as `chunks` takes it.

    Large batches share the costs of a call among more worlds. Each worker still gets
    two tasks or more, so that they end at about the same time.
    """
    return max(1, min(LARGEST, seeds // (CHUNK * 2 * max(workers, 1))))


@dataclass(frozen=True)
class Played:
    """The facts about written episodes that the episodes do not contain."""

    unled: tuple[tuple[int, str], ...] = ()
    missing_extra: str = ""


@dataclass(frozen=True)
class Measuring:
    """How the episodes of a task are measured."""

    plugins: tuple[str, ...] = ()  # names of metrics that are not part of benchnav
    registrations: tuple[Registration, ...] = ()  # which may include some of these metrics
    main: Mapping[str, str] = field(default_factory=dict)  # the script that registered metrics
    timeout: float = 300.0  # [s] that one value of such a metric may take


def work(task: Task, tick: Tick = lambda _: None) -> Outcome:
    """Run and measure a task in this process, without limits and protection against crashes.

    Its part is on disk when this returns, unless an extra is missing.

    Args:
        task: the task to run.
        tick: is called with the number of newly finished episodes.

    Raises:
        UnsolvableError: the scenario cannot be drawn.
        StoreError: the disk cannot be written.
    """
    played = play(task)
    if played.missing_extra:
        return Outcome(0, 0, missing_extra=played.missing_extra)
    return measure_part(task, played, lambda episodes: _measured_here(episodes, tick))


def play(task: Task) -> Played:
    """Run the episodes of a task, and write them for `measure_part`. Raises as `work`."""
    try:
        return _play(task)
    except MissingExtraError as error:
        return Played(missing_extra=str(error))


def _play(task: Task) -> Played:
    job = task.job
    if task.assignment.isolated:
        sandbox.hide_memory()  # before the memory holds salt and seeds
    worlds = []
    for number, seed in enumerate(task.seeds, 1):
        note_drawing(number)
        worlds.append((seed, job.world(seed)))
    note_drawing(0)
    unled: list[tuple[int, str]] = []
    with EpisodeFiles(Part(task.folder, task.first, task.stop)) as files:
        for batch in perform(task.assignment, worlds, task.forced_failure):
            beat()
            rehearsals = [e for performance in batch for e in performance.rehearsed.episodes]
            files.add(_timed(task, batch), rehearsals)
            unled += [(p.episode.identity.seed, team) for p in batch for team in p.unled]
        files.finish()
    return Played(tuple(sorted(unled)))


def measure_part(
    task: Task, played: Played, measure: Callable[[Iterator[Episode]], pa.Table]
) -> Outcome:
    """Measure the episodes that a worker wrote, and seal their part.

    Raises CorruptPartError if they are not the episodes of the task, StoreError if the disk cannot
    be written.
    """
    part = Part(task.folder, task.first, task.stop)
    expected = [task.assignment.identity(seed) for seed in task.seeds]
    seen: list[Seen] = []
    episodes = _compared(staged_episodes(part, expected), task.undisturbed)
    results = measure(_seen(episodes, seen))
    check_rehearsals(part, expected, task.assignment.rehearsals)
    seal(part, results, len(expected))
    return Outcome(
        len(expected), sum(one.redraws for one in seen),
        tuple(sorted((one.seed, one.failure) for one in seen if one.failure)),
        played.unled,
        tuple(sorted((one.seed, text) for one in seen for text in one_of_each_kind(one.remarks))),
        tuple(failed_metrics(results)),
        tracebacks={kind_of(one.failure): one.traceback for one in seen if one.traceback}
        | tracebacks_of(results),
    )  # fmt: skip


def _compared(episodes: Iterator[Episode], folder: Path | None) -> Iterator[Episode]:
    """Yield the episodes, each with the undisturbed one of its seed, if there is one."""
    if folder is None:
        return episodes
    stored = UndisturbedEpisodes(parts_of(folder))
    return (replace(e, undisturbed=partial(stored, e.identity.seed)) for e in episodes)


@dataclass(frozen=True)
class Seen:
    """The facts about an episode that the outcome needs."""

    seed: int
    redraws: int
    failure: str
    remarks: tuple[str, ...]
    traceback: str


def _seen(episodes: Iterator[Episode], seen: list[Seen]) -> Iterator[Episode]:
    for e in episodes:
        seen.append(Seen(e.identity.seed, e.world.redraws, e.failure, e.remarks, e.traceback))
        yield e


def _measured_here(episodes: Iterator[Episode], tick: Tick) -> pa.Table:
    return measured(_ticking(episodes, tick), all_metrics())


def _timed(task: Task, batch: list[Performance]) -> list[Episode]:
    """Return the episodes with peak memory, and with latency in the world of the probe seed."""
    timed = []
    for performance in batch:
        episode, grant = performance.episode, tuple(performance.rehearsed.grant)
        seeded: Seeded = (episode.identity.seed, episode.world)
        wanted = seeded[0] == task.probe and not (episode.failure or task.job.undisturbed)
        seconds = latency(task.assignment, seeded, grant) if wanted else None
        timings = replace(episode.timings, latency=seconds, memory=peak_memory())
        timed.append(replace(episode, timings=timings))
    return timed


def _ticking(episodes: Iterable[Episode], tick: Tick) -> Iterator[Episode]:
    for episode in episodes:
        yield episode
        tick(1)
