"""Check one part of a run: every episode, rehearsal and value in it."""

from collections import OrderedDict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from typing import Any

from benchnav.arena.world import World
from benchnav.arrays import FloatArray
from benchnav.episode.episode import Episode
from benchnav.errors import BenchnavError, CorruptPartError, ForeignRowError
from benchnav.generation.build import build
from benchnav.generation.rehearsal_world import rehearsal_world
from benchnav.generation.undisturbed_world import undisturbed_world
from benchnav.plugins import METRICS
from benchnav.runner.plan.job import Job
from benchnav.runner.plan.task import Measuring
from benchnav.runner.rollouts.rollout import Assignment, batches
from benchnav.runner.rollouts.seeding import phases
from benchnav.store.parts.part import Part
from benchnav.verify.difference import first_difference
from benchnav.verify.episode_check import check_commands, check_timings, compare
from benchnav.verify.finding import Report
from benchnav.verify.metric_check import check_values, expected_metrics, measured_again
from benchnav.verify.rehearsal_check import check_rehearsals
from benchnav.verify.resimulation import resimulate, unfit

_KEPT = 256  # worlds in the cache of a process: other navigators run in the same worlds
_WORLDS: OrderedDict[tuple[str, str, int], World] = OrderedDict()


@dataclass(frozen=True)
class PartCheck:
    """A part, and the context of its check."""

    job: Job
    part: Part
    salt: str
    probe: int  # the seed of the episode that stores latency
    version: str  # of the benchnav that made the run
    metrics: Mapping[str, bool]  # installed metrics, and whether they are verifiable
    measuring: Measuring | None  # how to measure metrics of plugins; None: in this process

    @property
    def assignment(self) -> Assignment:
        """The assignment of the navigator to the part's cell."""
        return replace(self.job.assignment, salt=self.salt)

    @property
    def shown(self) -> str:
        """The name of the cell in findings."""
        return self.job.shown

    def place(self, episode: Episode) -> str:
        """Return the name of an episode in findings."""
        rehearsal = episode.identity.rehearsal
        more = f", rehearsal {rehearsal}" if rehearsal else ""
        return f"{self.shown}, seed {episode.identity.seed}{more}"


@dataclass(frozen=True)
class Pair:
    """A stored episode, and the re-simulation of its commands in the redrawn world."""

    stored: Episode
    again: Episode
    touched: FloatArray  # (N, 2) [m] agent positions at the first touch of each event
    where: str


def check_part(task: PartCheck) -> tuple[Report, list[Pair], list[Pair]]:
    """Return (report, scored episodes, rehearsals) of a part."""
    report = Report()
    try:
        scored = list(task.part.episodes())
        rehearsed = list(task.part.rehearsals())
        rows = task.part.results().to_pylist()
    except CorruptPartError as error:
        kind = "identity" if isinstance(error, ForeignRowError) else "seal"
        report.find(kind, task.shown, str(error).split(" Delete ")[0])
        return report, [], []
    seeds = [e.identity.seed for e in scored]
    if seeds != list(task.part.seeds):
        report.find("coverage", task.shown, f"{task.part.stem} must hold its seeds; got {seeds}")
    try:
        fit = [e for e in scored if _identified(task, e, report)]
        fit_rehearsed = [e for e in rehearsed if _identified(task, e, report)]
        pairs = _again(task, fit, report)
        practice = _again(task, fit_rehearsed, report)
    except (BenchnavError, ArithmeticError, MemoryError, ValueError) as error:
        report.find("world", task.shown, f"cannot be drawn again: {type(error).__name__}: {error}")
        return report, [], []
    _check_rehearsals(task, fit, fit_rehearsed, report)
    _check_values(task, pairs, rows, report)
    report.counts["episodes"] += len(pairs)
    report.counts["rehearsals"] += len(practice)
    return report, pairs, practice


def _identified(task: PartCheck, episode: Episode, report: Report) -> bool:
    """Whether an episode belongs to this part; report one of another cell, seed or navigator."""
    identity = episode.identity
    right = replace(task.assignment.identity(identity.seed), rehearsal=identity.rehearsal)
    place = task.place(episode)
    text = first_difference(identity, right, "identity")
    if text:
        report.find("identity", place, text)
    if identity.seed not in task.part.seeds:
        report.find("identity", place, f"seed {identity.seed} is not one of {task.part.stem}")
        return False
    return True


def _again(task: PartCheck, episodes: Sequence[Episode], report: Report) -> list[Pair]:
    """Re-simulate episodes where possible, and compare."""
    checked: list[tuple[World, Episode]] = []
    for episode in episodes:
        world, place = _world(task, episode), task.place(episode)
        text = first_difference(episode.world, world, "world")
        if text:
            report.find("world", place, f"{text} (redrawn)")
        wrong = unfit(world, episode)
        if wrong:
            report.find("command", place, wrong)
        else:
            checked.append((world, episode))
    pairs = []
    for batch in _batches(checked):
        for (_, stored), (again, wrong, touched) in zip(batch, resimulate(batch), strict=True):
            place = task.place(stored)
            if wrong:
                report.find("state", place, wrong)
            compare(stored, again, place, report)
            check_commands(stored, again, place, report)
            probe = not stored.identity.rehearsal and stored.identity.seed == task.probe
            check_timings(stored, probe, place, report)
            pairs.append(Pair(stored, again, touched, place))
    return pairs


def _batches(
    checked: Sequence[tuple[World, Episode]],
) -> Iterator[list[tuple[World, Episode]]]:
    seeded = [(place, world) for place, (world, _) in enumerate(checked)]
    for batch in batches(seeded):
        yield [checked[place] for place, _ in batch]


def _world(task: PartCheck, episode: Episode) -> World:
    """Return the redrawn world of an episode."""
    job, seed, k = task.job, episode.identity.seed, episode.identity.rehearsal
    key = job.scenario.hash, job.split, seed
    world = _WORLDS.get(key)
    if world is None:
        world = _WORLDS[key] = build(job.scenario, job.split, seed)
        while len(_WORLDS) > _KEPT:
            _WORLDS.popitem(last=False)
    if job.undisturbed:
        return undisturbed_world(world)
    if not k:
        return world
    return rehearsal_world(world, phases(task.salt, *key, k))[0]


def _check_rehearsals(
    task: PartCheck, scored: Sequence[Episode], rehearsed: Sequence[Episode], report: Report
) -> None:
    def seed_of(episode: Episode) -> int:
        return episode.identity.seed

    made = {seed: list(group) for seed, group in groupby(rehearsed, seed_of)}
    for episode in scored:
        own = made.pop(seed_of(episode), [])
        check_rehearsals(task.assignment, episode, own, task.place(episode), report)
    for seed in made:
        report.find("rehearsal", task.shown, f"seed {seed} has rehearsals, but no episode")


def _check_values(
    task: PartCheck, pairs: Sequence[Pair], rows: Sequence[dict[str, Any]], report: Report
) -> None:
    """Check values of re-simulated episodes; others are reported already."""
    by_seed: dict[int, list[dict[str, Any]]] = {}
    for row in rows:
        by_seed.setdefault(row["seed"], []).append(row)
    stored = {row["metric"] for row in rows}
    names = expected_metrics(stored, task.version, task.metrics)
    if pairs:
        report.unmeasured |= set(METRICS.names()) - stored
    again = [replace(pair.again, identity=task.assignment.identity(_seed(pair))) for pair in pairs]
    right = measured_again(again, names, task.measuring)
    for pair, expected in zip(pairs, right, strict=True):
        check_values(by_seed.pop(_seed(pair), []), expected, task.metrics, pair.where, report)
    for seed in by_seed:
        if seed not in task.part.seeds:
            report.find(
                "metric", task.shown, f"there are values for seed {seed}, which has no episode"
            )


def _seed(pair: Pair) -> int:
    return pair.stored.identity.seed
