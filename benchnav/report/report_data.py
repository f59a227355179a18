"""The content of the runs of a report, read once."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from benchnav.arena.world import World
from benchnav.episode.episode import Episode
from benchnav.leaderboard.columns import choose
from benchnav.leaderboard.from_runs import StoredValues
from benchnav.leaderboard.record import Leaderboard
from benchnav.report.analysis.episode_summary import EpisodeSummary, summarise
from benchnav.report.line_style import LineStyle, line_styles
from benchnav.scenario.terms import TRACKS
from benchnav.store.runs.run_folder import RunFolder

WORLDS = 6  # of each scenario that are kept for its pictures

MORE = (
    "timeout", "stuck", "failed", "min_clearance", "path_length", "efficiency",
    "personal_space_intimate", "planning_time", "latency_p95",
)  # fmt: skip
"""Metrics of a report besides those of a leaderboard."""

Receive = Callable[[Episode, tuple[str, ...]], None]
"""Receives each stored episode once, and the tracks for which it stands."""


@dataclass(frozen=True, kw_only=True, eq=False)
class StoredScenario:
    """A scenario of the runs, as they stored it."""

    identity: str  # "trap/u@1"
    hash: str
    config: Mapping[str, Any]  # title, description, parameters, teams, …
    worlds: tuple[World, ...]  # of the first stored seeds, at most `WORLDS`
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
    navigators: tuple[str, ...]  # labels, in the order of the suites
    scenarios: tuple[StoredScenario, ...]  # in the order of the suites
    tracks: tuple[str, ...]  # in the order of `TRACKS`
    styles: Mapping[str, LineStyle]  # label → colour, dash and mark
    summaries: tuple[EpisodeSummary, ...]  # of every stored episode
    navigator_configs: Mapping[str, Mapping[str, Any]]  # label → its entry in the manifest


def family_of(scenario: str) -> str:
    """Return the first part of the name of a scenario: ``trap`` of ``trap/u@1``."""
    return scenario.partition("@")[0].partition(":")[0].partition("/")[0]


def read_runs(
    folders: Sequence[RunFolder],
    values: StoredValues,
    metrics: Sequence[str] | None = None,
    receive: Receive | None = None,
) -> ReportData:
    """Read each stored episode of some runs once.

    Args:
        folders: the runs.
        values: their measured values.
        metrics: names of metrics on the board, or "all"; None: the usual ones and `MORE`.
        receive: also receives each episode.

    Raises UsageError for an unknown metric, CorruptPartError for a damaged part.
    """
    shown = _metrics(values.names, metrics)
    worlds: dict[str, dict[int, World]] = {}
    summaries = []
    for episode, tracks in _episodes(folders):
        summaries.append(summarise(episode, tracks))
        _keep_world(worlds.setdefault(episode.identity.scenario, {}), episode)
        if receive is not None:
            receive(episode, tracks)
    entries = [e for folder in folders for e in folder.manifest.suite["navigators"]]
    held = set(values.results["navigator"].unique().to_pylist())
    held |= {cell.navigator for cell in values.not_applicable}
    navigators = tuple(dict.fromkeys(e["label"] for e in entries if e["label"] in held))
    return ReportData(
        folders=tuple(folders), values=values, board=values.board(shown), metrics=shown,
        navigators=navigators, scenarios=_scenarios(folders, worlds), tracks=_tracks(folders),
        styles=line_styles(navigators), summaries=tuple(summaries),
        navigator_configs={e["label"]: e for e in reversed(entries)},
    )  # fmt: skip


def _episodes(folders: Sequence[RunFolder]) -> Iterator[tuple[Episode, tuple[str, ...]]]:
    """Yield each episode once, although several runs may hold it, and its tracks."""
    known = set()
    for folder in folders:
        for cell in folder.manifest.cells:
            if cell["reason"]:
                continue
            tracks = (*cell.get("also", ()), cell["track"])
            for part in folder.parts_in(cell):
                for episode in part.episodes():
                    key = (cell["key"], episode.identity.seed)
                    if key not in known:
                        known.add(key)
                        yield episode, tracks


def _keep_world(kept: dict[int, World], episode: Episode) -> None:
    """Keep the worlds of the smallest seeds."""
    seed = episode.identity.seed
    if seed in kept or (len(kept) == WORLDS and seed > max(kept)):
        return
    kept[seed] = episode.world
    if len(kept) > WORLDS:
        del kept[max(kept)]


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
