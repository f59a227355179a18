"""Read the stored episodes of runs once, part by part, with all cores."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

from benchnav.arena.world import World
from benchnav.processes.worker_pool import submitted, worker_pool
from benchnav.report.analysis.episode_summary import EpisodeSummary, summarise
from benchnav.report.failed_episodes import Cell
from benchnav.report.replays import ReplayPlan, write_replay
from benchnav.scenario.condition import perception_of
from benchnav.store.parts.part import Part
from benchnav.store.runs.run_folder import RunFolder
from benchnav.threads import core_count

WORLDS = 6  # of each scenario that are kept for its pictures
MANY = 300  # episodes from which processes pay for their start
REPLAY = 15  # episodes are read in the time in which a replay is made

Advance = Callable[[int], None]


@dataclass(frozen=True)
class PartReading:
    """A part, and the seeds, worlds and replays to read from it."""

    part: Part
    scenario: str
    tracks: tuple[str, ...]  # for which its episodes stand
    perception: str
    seeds: frozenset[int]  # to read: no other part of the report holds them
    worlds: frozenset[int] = frozenset()  # seeds whose worlds are kept
    replays: tuple[tuple[str, int], ...] = ()  # track and seed of each replay
    plan: ReplayPlan | None = None

    @property
    def cost(self) -> int:
        """The time of the reading, in episodes."""
        return len(self.seeds) + REPLAY * len(self.replays)


@dataclass(frozen=True, eq=False)
class PartContent:
    """The summaries, worlds and replays of a part."""

    summaries: tuple[EpisodeSummary, ...]
    worlds: dict[int, World]  # by seed
    replays: tuple[Cell, ...]  # that were written


def readings_of(folders: Sequence[RunFolder], plan: ReplayPlan | None) -> list[PartReading]:
    """Return how to read each stored episode once, although several runs may hold it."""
    found, known = list[PartReading](), dict[str, set[int]]()
    for folder in folders:
        for cell in folder.manifest.cells:
            if not cell["reason"] and not folder.manifest.is_undisturbed(cell):
                found += _cell_readings(folder, cell, known.setdefault(cell["key"], set()), plan)
    return _with_worlds(found)


def _cell_readings(
    folder: RunFolder, cell: Any, known: set[int], plan: ReplayPlan | None
) -> Iterator[PartReading]:
    """Yield how to read the parts of a cell; ``known`` seeds were read before."""
    tracks = (*cell.get("also", ()), cell["track"])
    chosen = {} if plan is None else plan.seeds
    perception = perception_of(cell)
    wanted = [(t, chosen.get((cell["navigator"], cell["scenario"], t, perception))) for t in tracks]
    for part in folder.parts_in(cell):
        seeds = frozenset(part.seeds) - known
        known |= seeds
        replays = tuple((track, seed) for track, seed in wanted if seed in seeds)
        yield PartReading(
            part, cell["scenario"], tracks, perception, seeds, replays=replays, plan=plan
        )


def _with_worlds(readings: Sequence[PartReading]) -> list[PartReading]:
    """Return the readings; the first ones of each scenario keep the worlds of its first seeds."""
    seeds = dict[str, set[int]]()
    for reading in readings:
        seeds.setdefault(reading.scenario, set()).update(reading.seeds)
    left = {scenario: set(sorted(each)[:WORLDS]) for scenario, each in seeds.items()}
    found = []
    for reading in readings:
        worlds = reading.seeds & left[reading.scenario]
        left[reading.scenario] -= worlds
        found.append(replace(reading, worlds=worlds))
    return found


def read_parts(readings: Sequence[PartReading], advance: Advance) -> Iterator[PartContent]:
    """Yield the contents in the order of the readings. Raises CorruptPartError."""
    for content in _contents(readings):
        advance(len(content.summaries))
        yield content


def _contents(readings: Sequence[PartReading]) -> Iterator[PartContent]:
    workers = min(core_count(), len(readings))
    if workers < 2 or sum(reading.cost for reading in readings) < MANY:
        yield from map(read_part, readings)
        return
    with worker_pool(workers, "Free memory, or ask for fewer replays.") as pool:
        for future in submitted(pool, read_part, readings):
            yield future.result()


def read_part(reading: PartReading) -> PartContent:
    """Read a part, and write its replays."""
    summaries, worlds, replays = list[EpisodeSummary](), dict[int, World](), list[Cell]()
    for episode in reading.part.episodes():
        identity = episode.identity
        if identity.seed not in reading.seeds:
            continue
        summaries.append(summarise(episode, reading.tracks))
        if identity.seed in reading.worlds:
            worlds[identity.seed] = episode.world
        for track, seed in reading.replays:
            if seed == identity.seed and reading.plan is not None:
                shown = replace(episode, identity=replace(identity, track=track))
                write_replay(shown, reading.plan.folder)
                cell = identity.navigator, identity.scenario, track, reading.perception
                replays.append(cell)
    return PartContent(tuple(summaries), worlds, tuple(replays))
