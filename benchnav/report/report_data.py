"""The content of the runs of a report, read once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import Any

from benchnav.arena.world import World
from benchnav.leaderboard.columns import choose
from benchnav.leaderboard.from_runs import StoredValues
from benchnav.leaderboard.record import Leaderboard
from benchnav.navigation.plugin.trainings import entries_of, entry_of
from benchnav.report.analysis.episode_summary import EpisodeSummary
from benchnav.report.failed_episodes import Cell
from benchnav.report.line_style import LineStyle, line_styles
from benchnav.report.part_reading import read_parts, readings_of
from benchnav.report.replays import ReplayPlan
from benchnav.runner.execute.progress import Progress
from benchnav.scenario.condition import EXACT, perceptions_of
from benchnav.scenario.terms import PERCEPTIONS, TRACKS
from benchnav.store.runs.run_folder import RunFolder

MORE = (
    "timeout", "stuck", "failed", "min_clearance", "path_length", "efficiency",
    "personal_space_intimate", "planning_time", "latency_p95",
)  # fmt: skip
"""Metrics of a report besides those of a leaderboard."""


@dataclass(frozen=True, kw_only=True, eq=False)
class StoredScenario:
    """A scenario of the runs, as they stored it."""

    identity: str  # "trap/u@1"
    hash: str
    config: Mapping[str, Any]  # title, description, parameters, teams, …
    worlds: tuple[World, ...]  # of the first stored seeds, at most six
    seeds: tuple[int, ...]  # of these worlds

    @property
    def family(self) -> str:
        """The first part of its name."""
        return family_of(self.identity)


@dataclass(frozen=True, kw_only=True, eq=False)
class ReportData:
    """Everything that the pages of a report show."""

    folders: tuple[RunFolder, ...]
    values: StoredValues  # measured values of all metrics, definitions, caveats, n/a cells
    board: Leaderboard  # of `metrics`
    metrics: tuple[str, ...]  # on the board, the usual ones first
    navigators: tuple[str, ...]  # entries, in the order of the suites
    scenarios: tuple[StoredScenario, ...]  # in the order of the suites
    tracks: tuple[str, ...]  # in the order of `TRACKS`
    perceptions: tuple[str, ...]  # in the order of `PERCEPTIONS`
    styles: Mapping[str, LineStyle]  # entry or label → colour, dash and mark
    summaries: tuple[EpisodeSummary, ...]  # of every stored episode
    replays: frozenset[Cell]  # whose first failed episode has a replay
    navigator_configs: Mapping[str, Mapping[str, Any]]
    """Entry → its navigator in the manifest; the first of several trainings."""

    @property
    def is_exact(self) -> bool:
        """Whether all perception is exact: pages then say nothing about perception."""
        return self.perceptions == (EXACT,)

    @property
    def conditions(self) -> list[tuple[str, str]]:
        """Every (track, perception), in the order of tables."""
        return list(product(self.tracks, self.perceptions))


def family_of(scenario: str) -> str:
    """Return the first part of the name of a scenario: ``trap`` of ``trap/u@1``."""
    return scenario.partition("@")[0].partition(":")[0].partition("/")[0]


def read_runs(
    folders: Sequence[RunFolder],
    values: StoredValues,
    metrics: Sequence[str] | None = None,
    plan: ReplayPlan | None = None,
    progress: Progress | None = None,
) -> ReportData:
    """Read each stored episode of some runs once, and write the replays.

    Args:
        folders: the runs.
        values: their measured values.
        metrics: names of metrics on the board, or "all"; None: the usual ones and `MORE`.
        plan: the replays to write; None: none.
        progress: is notified of every episode that was read; None: no progress.

    Raises UsageError for an unknown metric, CorruptPartError for a damaged part.
    """
    shown = _metrics(values.names, metrics)
    worlds: dict[str, dict[int, World]] = {}
    summaries, replays = list[EpisodeSummary](), list[Cell]()
    readings, display = readings_of(folders, plan), progress or Progress()
    display.begin(sum(len(reading.seeds) for reading in readings), 0)
    try:
        for reading, content in zip(readings, read_parts(readings, display.advance), strict=True):
            summaries += content.summaries
            replays += content.replays
            worlds.setdefault(reading.scenario, {}).update(content.worlds)
    finally:
        display.end()
    entries = [e for folder in folders for e in folder.manifest.suite["navigators"]]
    held = set(values.results["navigator"].unique().to_pylist())
    held |= {cell.navigator for cell in values.not_applicable}
    labels = [e["label"] for e in entries if {e["label"], entry_of(e["label"])} & held]
    navigators = entries_of(labels)
    styles = line_styles(navigators)
    return ReportData(
        folders=tuple(folders), values=values, board=values.board(shown), metrics=shown,
        navigators=navigators, scenarios=_scenarios(folders, worlds), tracks=_tracks(folders),
        perceptions=_perceptions(folders),
        styles={**{label: styles[entry_of(label)] for label in labels}, **styles},
        summaries=tuple(replace(s, navigator=entry_of(s.navigator)) for s in summaries),
        replays=frozenset(replays),
        navigator_configs={entry_of(e["label"]): e for e in reversed(entries)},
    )  # fmt: skip


def _metrics(held: Sequence[str], named: Sequence[str] | None) -> tuple[str, ...]:
    if named is not None:
        return choose(held, named)
    usual = choose(held, None)
    return tuple(dict.fromkeys([*usual, *(name for name in MORE if name in held)]))


def _scenarios(
    folders: Sequence[RunFolder], worlds: Mapping[str, Mapping[int, World]]
) -> tuple[StoredScenario, ...]:
    found: dict[str, StoredScenario] = {}
    for entry in (e for folder in folders for e in folder.manifest.suite["scenarios"]):
        identity = str(entry["scenario"])
        kept = worlds.get(identity, {})
        seeds = tuple(sorted(kept))
        found.setdefault(
            identity,
            StoredScenario(
                identity=identity, hash=str(entry["hash"]), config=entry["config"],
                worlds=tuple(kept[seed] for seed in seeds), seeds=seeds,
            ),
        )  # fmt: skip
    return tuple(found.values())


def _tracks(folders: Sequence[RunFolder]) -> tuple[str, ...]:
    held = {track for folder in folders for track in folder.manifest.suite["tracks"]}
    return tuple(track for track in TRACKS if track in held)


def _perceptions(folders: Sequence[RunFolder]) -> tuple[str, ...]:
    held = {each for folder in folders for each in perceptions_of(folder.manifest.suite)}
    return tuple(each for each in PERCEPTIONS if each in held)
