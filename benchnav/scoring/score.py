"""Measure a table of trajectories: rows as those of a run's results."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
import pyarrow as pa

from benchnav.arena.world import World
from benchnav.arrays import IntArray
from benchnav.config.document import shown
from benchnav.episode.episode import Identity
from benchnav.errors import TrajectoryError, UsageError
from benchnav.metrics.measure import measure, subjects
from benchnav.metrics.metric import Metric
from benchnav.scenario.terms import PERCEPTIONS, SPLITS, TRACKS
from benchnav.scoring.recorded_episode import recorded_episode
from benchnav.scoring.requirements import cures, reason
from benchnav.scoring.setting import Options, setting_of
from benchnav.scoring.table_file import Table
from benchnav.scoring.tracks import Gaps, read_tracks
from benchnav.store.parts.results import RESULTS

if TYPE_CHECKING:
    from benchnav.scenario.scenario import Scenario

RECORDING = "recording"
"""The scenario of a table without a scenario."""
_KEYS = ("navigator", "scenario", "track", "perception", "split", "seed")


@dataclass(frozen=True, kw_only=True)
class Reading:
    """How the rows of a table become tracks."""

    rate: float | None = None  # [Hz] of frames
    step: float | None = None  # [s]; None: that of the table
    gaps: Gaps = "refuse"


@dataclass(frozen=True, kw_only=True)
class Subject:
    """The identity of the rows of a table that has no such columns."""

    navigator: str
    track: str
    perception: str
    seed: int
    scenarios: Mapping[str, "Scenario"] = field(default_factory=dict)  # identity → scenario


def score_table(
    table: Table, subject: Subject, reading: Reading, options: Options, metrics: Sequence[Metric]
) -> tuple[pa.Table, tuple[str, ...]]:
    """Return the results, of the schema `RESULTS`, and remarks on the table.

    Rows with different navigators, scenarios, tracks or seeds are different episodes.
    """
    rows: list[dict[str, Any]] = []
    remarks, missing = dict[str, None](), dict[str, None]()
    for key, members in _episodes(table):
        tracks = read_tracks(
            table, members, rate=reading.rate, step=reading.step, gaps=reading.gaps
        )
        scenario = _scenario(table, key, subject)
        identity = _identity(table, key, subject, scenario)
        setting = setting_of(table, tracks, options, _world(scenario, identity))
        remarks |= dict.fromkeys(setting.remarks)
        found = recorded_episode(tracks, setting, identity)
        missing |= dict.fromkeys(cures(setting.known))
        known = setting.known | ({"common_start"} if tracks.together else set())
        why = {metric.name: reason(metric, known) for metric in metrics}
        able = [metric for metric in metrics if not why[metric.name]]
        rows += measure(found.each, [m for m in able if m.scope == "agent"])
        rows += measure(found.all, [m for m in able if m.scope == "group"])
        common = [row for row, _ in subjects(found.each)]
        rows += _not_applicable(common, why)
    if missing:
        remarks |= dict.fromkeys(["More metrics are defined with", *(f"- {m}" for m in missing)])
    return pa.Table.from_pylist(rows, RESULTS), tuple(remarks)


def _not_applicable(common: list[dict[str, Any]], why: dict[str, str]) -> Iterator[dict[str, Any]]:
    for row in common:
        for name, text in why.items():
            if text:
                yield row | {"metric": name, "value": np.nan, "defined": 0, "missing": text}


def _episodes(table: Table) -> Iterator[tuple[dict[str, Any], IntArray]]:
    """Yield the key and the rows of each episode, in the order of the file."""
    held = [name for name in _KEYS if name in table.frame]
    if not held:
        yield {}, np.arange(len(table))
        return
    for key, index in table.frame.groupby(held, sort=False).indices.items():
        parts = key if isinstance(key, tuple) else (key,)
        yield dict(zip(held, parts, strict=True)), np.asarray(index, np.int64)


def _scenario(table: Table, key: dict[str, Any], subject: Subject) -> "Scenario | None":
    """Return the scenario of an episode; None if none is given."""
    known = subject.scenarios
    if not known:
        return None
    held = str(key.get("scenario", ""))
    if not held and len(known) == 1:
        return next(iter(known.values()))
    if held not in known:
        raise UsageError(
            f"The scenario must be that of the table, which is {held or 'not named'} in"
            f" {table.path}. Got {', '.join(known)}."
        )
    return known[held]


def _identity(
    table: Table, key: dict[str, Any], subject: Subject, scenario: "Scenario | None"
) -> Identity:
    track, split = str(key.get("track", subject.track)), str(key.get("split", "test"))
    perception = str(key.get("perception", subject.perception))
    for name, value, allowed in (
        ("track", track, TRACKS), ("perception", perception, PERCEPTIONS), ("split", split, SPLITS),
    ):  # fmt: skip
        if value not in allowed:
            raise TrajectoryError(
                f"{table.path}: a {name} must be one of {', '.join(allowed)}; got {shown(value)!r}."
            )
    seed = float(key.get("seed", subject.seed))
    if seed != int(seed) or not 0 <= seed < 2**31:
        raise TrajectoryError(f"{table.path}: a seed must be a whole number ≥ 0; got {seed:g}.")
    return Identity(
        scenario=str(key.get("scenario", RECORDING)) if scenario is None else scenario.identity,
        scenario_hash="" if scenario is None else scenario.hash, split=split, seed=int(seed),
        track=track, navigator=str(key.get("navigator", subject.navigator)), perception=perception,
    )  # fmt: skip


def _world(scenario: "Scenario | None", identity: Identity) -> World | None:
    if scenario is None:
        return None
    from benchnav.generation.build import build

    return build(scenario, identity.split, identity.seed)
