"""Runs → the text of a table, a comparison, a curve. Imported once a verb needs it."""

import re
from collections.abc import Collection, Iterator, Sequence
from typing import Any

import pyarrow as pa
import pyarrow.compute as pc

from benchnav.cli.console import say
from benchnav.errors import StoreError, UsageError, did_you_mean
from benchnav.leaderboard.caveats import metric_caveats, table_caveats
from benchnav.leaderboard.columns import choose, choose_columns
from benchnav.leaderboard.label import require_one_navigator_per_label
from benchnav.leaderboard.marks import labels_of, marked
from benchnav.leaderboard.record import NotApplicable
from benchnav.leaderboard.rendering.formats import render
from benchnav.leaderboard.statistics.curve import (
    HORIZON,
    Point,
    Setting,
    horizon_curves,
    parameter_curves,
)
from benchnav.leaderboard.statistics.head_to_head import Duel, duel
from benchnav.leaderboard.table import leaderboard
from benchnav.metrics.declared import declared_metrics
from benchnav.metrics.metric import Metric
from benchnav.metrics.success import SUCCESS
from benchnav.scenario.parameters import joined_parameters, split_parameters
from benchnav.store.runs.manifest import IN_PROCESS
from benchnav.store.runs.reading import episodes_in_every_track, results_of
from benchnav.store.runs.run_folder import RunFolder

TIDY = ("csv", "json")  # hold every metric unless told otherwise
_COMPARED = ("success", "collided", "spl", "time_to_goal")  # by these unless told otherwise


def table(
    folders: Sequence[RunFolder],
    format: str,
    metric: Sequence[str] | None,
    recompute: bool,
    verified: Sequence[bool] = (),
    columns: Sequence[str] | None = None,
) -> str:
    """The leaderboard; only what is shown is computed. ``verified`` says it of each run."""
    metrics = _metrics()
    tables = _tables(folders, metrics, recompute)
    caveats = [*table_caveats(folders, tables), *metric_caveats(tables, metrics)]
    results = _joined(folders, tables)
    held = _held(results, metrics)
    if columns is not None:
        metric = [name for name in choose_columns(held, columns) if name in held]
    shown = choose(held, ["all"] if metric is None and format in TIDY else metric)
    results = results.filter(pc.is_in(results["metric"], pa.array(shown)))
    missing = dict.fromkeys(gap for folder in folders for gap in _not_applicable(folder))
    said = dict[str, dict[str, Any]]()  # by label; only of those of which a run holds rows
    for folder, rows in zip(folders, tables, strict=True):
        said |= _said(folder, labels_of(rows))
    made = leaderboard(
        results, metrics, list(missing),
        {label: entry["training"] for label, entry in said.items() if "training" in entry},
        marked(folders, tables, verified),
        {label for label, entry in said.items() if not entry["uses_map"]},
        {label: entry["mode"] for label, entry in said.items()}, caveats,
    )  # fmt: skip
    if columns is not None:
        return render(made, format, columns=columns)
    return render(made, format, shown if metric or format in TIDY else None)


def comparison(
    folders: Sequence[RunFolder],
    pair: tuple[str, str],
    metric: Sequence[str] | None,
    scenario: Sequence[str],
    recompute: bool,
) -> tuple[Duel, dict[str, Metric]]:
    """Two navigators against each other, by ``metric`` or the few that matter most."""
    metrics = _metrics()
    results = _results(folders, metrics, recompute)
    if scenario:
        results = _within(results, scenario)
    held = _held(results, metrics)
    names = [name for name in choose(held, metric or _COMPARED) if name in metrics]
    gaps = [gap for folder in folders for gap in _not_applicable(folder)]
    return duel(results, metrics, names, *pair, gaps), metrics


def curve(
    folders: Sequence[RunFolder], axis: str, metric: str, recompute: bool
) -> tuple[Point, ...]:
    """Success against horizon from the stored episodes; a metric against a parameter."""
    metrics = _metrics()
    if axis == HORIZON:
        _tables(folders, {}, recompute=False)  # refuses what must not be merged
        if metric != SUCCESS.name:
            raise UsageError(f"Against horizon there is success alone. Got {metric!r} instead.")
        return horizon_curves(e for f in folders for e in episodes_in_every_track(f))
    settings = _settings(folders, axis)
    results = _results(folders, metrics, recompute)
    choose(_held(results, metrics), [metric])
    return parameter_curves(results, metrics[metric], axis, settings)


def _names(scenario: str) -> tuple[str, ...]:
    """What a scenario may be called: its name alone, with parameters, with version, with both."""
    named = re.sub(r"@\d+", "", scenario)
    return named.split(":")[0], scenario.split(":")[0], scenario, named


def _within(results: pa.Table, wanted: Sequence[str]) -> pa.Table:
    """The rows of scenarios that are named: with or without version and parameters."""
    names = {known: _names(known) for known in results["scenario"].unique().to_pylist()}
    chosen = set()
    for name in wanted:
        found = {known for known, said in names.items() if name in said}
        if not found:
            every = sorted({said[-1] for said in names.values()})
            raise UsageError(
                f"A scenario to compare in must be one that was run. Got {name!r} instead."
                f"{did_you_mean(name, every)}"
            )
        chosen |= found
    return results.filter(pc.is_in(results["scenario"], pa.array(sorted(chosen))))


def _settings(folders: Sequence[RunFolder], axis: str) -> dict[str, Setting]:
    """Where the scenarios of some runs stand that have the parameter ``axis``."""
    found, axes = {}, {HORIZON}
    for entry in (e for folder in folders for e in folder.manifest.suite["scenarios"]):
        declared = entry["says"].get("parameters", {})
        axes |= set(declared)
        if axis in declared:
            base, given = split_parameters(entry["scenario"])
            x = given.pop(axis, declared[axis]["default"])
            unit = re.search(r"\[([^\]]+)\]$", declared[axis]["description"])
            found[entry["scenario"]] = Setting(
                base + joined_parameters(given), x, unit[1] if unit else ""
            )
    if not found:
        raise UsageError(
            f"--curve must be {HORIZON!r}, or a parameter of a scenario that was run:"
            f" {', '.join(sorted(axes - {HORIZON})) or 'here is none'}. Got {axis!r} instead."
            f"{did_you_mean(axis, sorted(axes))}"
        )
    return found


def _metrics() -> dict[str, Metric]:
    """Every metric that is installed, by name; says which cannot be used."""
    metrics, broken = declared_metrics()
    for cause in broken:
        say(f"{cause} It is left out.")
    return metrics


def _tables(
    folders: Sequence[RunFolder], metrics: dict[str, Metric], recompute: bool
) -> list[pa.Table]:
    """Measured values of each run; a label must stand for one navigator in all of them."""
    stored = [results_of(folder) for folder in folders]
    named = zip(folders, stored, strict=True)
    require_one_navigator_per_label({str(f.shown): results for f, results in named})
    if not recompute:
        return stored
    from benchnav.runner.execute.remeasurement import recomputed

    return [recomputed(folder, list(metrics.values())) for folder in folders]


def _joined(folders: Sequence[RunFolder], tables: Sequence[pa.Table]) -> pa.Table:
    joined = pa.concat_tables(tables, promote_options="default")
    if not len(joined):
        raise StoreError(
            f"There must be episodes to make a table of. {folders[0].shown} holds none."
        )
    return joined


def _results(folders: Sequence[RunFolder], metrics: dict[str, Metric], recompute: bool) -> pa.Table:
    return _joined(folders, _tables(folders, metrics, recompute))


def _held(results: pa.Table, metrics: dict[str, Metric]) -> list[str]:
    """The metrics of some results, in the order of their definitions."""
    held = set(results["metric"].unique().to_pylist())
    return [*(name for name in metrics if name in held), *sorted(held - set(metrics))]


def _said(folder: RunFolder, labels: Collection[str]) -> dict[str, dict[str, Any]]:
    """What a run says of its navigators: training (decisions, seconds), map and mode."""
    found: dict[str, dict[str, Any]] = {}
    for entry in folder.manifest.suite.get("navigators", ()):
        if entry["label"] not in labels:
            continue
        found[entry["label"]] = said = {
            "mode": entry.get("mode", IN_PROCESS), "uses_map": entry.get("uses_map") is not False,
        }  # fmt: skip
        if "training" in entry:
            said["training"] = entry["training"]["decisions"], entry["training"]["seconds"]
    return found


def _not_applicable(folder: RunFolder) -> Iterator[NotApplicable]:
    entries = folder.manifest.suite.get("navigators", ())
    asked = {entry["label"]: int(entry.get("rehearsal", 0)) for entry in entries}
    for cell in folder.manifest.cells:
        if cell["reason"]:
            yield NotApplicable(
                cell["navigator"], cell["scenario"], cell["track"], cell["reason"],
                asked.get(cell["navigator"], 0),
            )  # fmt: skip
