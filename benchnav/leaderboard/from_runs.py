"""Leaderboards, comparisons and curves from run folders."""

import re
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import pyarrow as pa
import pyarrow.compute as pc

from benchnav.errors import StoreError, UsageError, did_you_mean
from benchnav.leaderboard.caveats import metric_caveats, table_caveats
from benchnav.leaderboard.columns import choose, choose_columns
from benchnav.leaderboard.label import require_one_navigator_per_label
from benchnav.leaderboard.marks import marked
from benchnav.leaderboard.navigator_facts import (
    Facts,
    entries_of_all,
    facts_in,
    facts_of_entries,
    trained_in,
)
from benchnav.leaderboard.record import Leaderboard, NotApplicable
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
from benchnav.navigation.plugin.trainings import entry_of
from benchnav.runner.plan.installed_differences import Caveat
from benchnav.scenario.condition import perception_of
from benchnav.scenario.parameters import joined_parameters, split_parameters
from benchnav.store.runs.reading import encoded_results_of, episodes_in_every_track
from benchnav.store.runs.run_folder import RunFolder

SUCCESS = "success"
LONG_FORMATS = ("csv", "json")  # hold every metric unless some are named
COMPARED = ("success", "collided", "spl", "time_to_goal")  # the default metrics of a comparison

Notify = Callable[[str], None]
"""Receives messages for the user, such as the reason why a metric is left out."""


@dataclass(frozen=True, kw_only=True, eq=False)
class StoredValues:
    """The measured values of one or more runs, and the facts that their tables show."""

    results: pa.Table  # of the schema `benchnav.store.parts.results.RESULTS`, or encoded
    metrics: Mapping[str, Metric]  # every installed metric
    caveats: Sequence[Caveat]
    not_applicable: Sequence[NotApplicable]
    verified: Collection[str]  # entries
    facts: Facts  # entry → mode, uses_map, training

    @property
    def names(self) -> list[str]:
        """The metrics that the results hold, in the order of their definitions."""
        return _held(self.results, self.metrics)

    def board(self, metrics: Sequence[str]) -> Leaderboard:
        """Return the leaderboard of these ``metrics``; others are not computed."""
        chosen = self.results.filter(pc.is_in(self.results["metric"], pa.array(metrics)))
        facts = self.facts
        return leaderboard(
            chosen, self.metrics, self.not_applicable,
            {label: fact["training"] for label, fact in facts.items() if "training" in fact},
            self.verified,
            {label for label, fact in facts.items() if not fact["uses_map"]},
            {label: fact["mode"] for label, fact in facts.items()}, self.caveats,
        )  # fmt: skip

    def shown(
        self, format: str, metrics: Sequence[str] | None, columns: Sequence[str] | None
    ) -> tuple[str, ...]:
        """Return the metrics that a table in this format needs.

        Raises UsageError for an unknown metric or column, and for metrics beside columns.
        """
        if columns is not None and metrics is not None:
            raise UsageError("Columns name their metrics. Got metrics, too: name them as columns.")
        if columns is not None:
            names = self.names
            metrics = [name for name in choose_columns(names, columns) if name in names]
        elif metrics is None and format in LONG_FORMATS:
            metrics = ["all"]
        return choose(self.names, metrics)

    def text(
        self,
        format: str,
        metrics: Sequence[str] | None = None,
        columns: Sequence[str] | None = None,
    ) -> str:
        """Return the leaderboard as text, in a format of `benchnav.leaderboard.render`."""
        shown = self.shown(format, metrics, columns)
        board = self.board(shown)
        if columns is not None:
            return render(board, format, columns=columns)
        return render(board, format, shown if metrics or format in LONG_FORMATS else None)


def stored_values(
    folders: Sequence[RunFolder],
    *,
    recompute: bool = False,
    verified: Sequence[bool] = (),
    notify: Notify,
) -> StoredValues:
    """Return the values of some runs.

    Args:
        folders: the runs.
        recompute: measure the stored episodes again, with every installed metric.
        verified: whether each run was verified on this machine.
        notify: receives why a metric cannot be used.

    Raises UsageError where one label stands for two navigators, StoreError where there are no
    episodes.
    """
    metrics = _installed_metrics(notify)
    tables = _tables(folders, metrics, recompute)
    gaps = dict.fromkeys(gap for folder in folders for gap in _not_applicable(folder))
    facts = facts_in(folders, tables)
    return StoredValues(
        results=_joined(folders, tables),
        metrics=metrics,
        caveats=[*table_caveats(folders, tables), *metric_caveats(tables, metrics)],
        not_applicable=list(gaps),
        verified=entries_of_all(marked(folders, tables, verified), facts),
        facts=facts_of_entries(facts),
    )


def comparison(
    folders: Sequence[RunFolder],
    pair: tuple[str, str],
    *,
    metrics: Sequence[str] | None = None,
    scenarios: Sequence[str] = (),
    recompute: bool = False,
    notify: Notify,
) -> tuple[Duel, dict[str, Metric]]:
    """Compare two navigators by ``metrics``, or by `COMPARED`; also return the definitions."""
    known = _installed_metrics(notify)
    results = _joined(folders, _tables(folders, known, recompute))
    if scenarios:
        results = _within(results, scenarios)
    held = _held(results, known)
    names = [name for name in choose(held, metrics or COMPARED) if name in known]
    gaps = [gap for folder in folders for gap in _not_applicable(folder)]
    trained = {name for folder in folders for name in trained_in(folder)}
    return duel(results, known, names, *pair, gaps, trained), known


def curve(
    folders: Sequence[RunFolder],
    axis: str,
    metric: str = SUCCESS,
    *,
    recompute: bool = False,
    notify: Notify,
) -> tuple[Point, ...]:
    """Return success against the horizon, or a metric against a parameter of scenarios."""
    metrics = _installed_metrics(notify)
    if axis == HORIZON:
        _tables(folders, {}, recompute=False)  # refuses what must not be merged
        if metric != SUCCESS:
            raise UsageError(f"Against horizon there is success alone. Got {metric!r} instead.")
        return horizon_curves(e for f in folders for e in episodes_in_every_track(f))
    settings = settings_of(folders, axis)
    results = _joined(folders, _tables(folders, metrics, recompute))
    choose(_held(results, metrics), [metric])
    return parameter_curves(results, metrics[metric], axis, settings)


def names_of_scenario(scenario: str) -> tuple[str, ...]:
    """Return its names: alone, with version, with both version and parameters, with parameters."""
    named = re.sub(r"@\d+", "", scenario)
    return named.split(":")[0], scenario.split(":")[0], scenario, named


def matching_scenarios(known: Collection[str], wanted: Sequence[str]) -> set[str]:
    """Return the scenarios that are named, with or without version and parameters.

    Raises UsageError for a name that stands for none of the ``known`` scenarios.
    """
    names = {scenario: names_of_scenario(scenario) for scenario in known}
    chosen: set[str] = set()
    for name in wanted:
        found = {scenario for scenario, forms in names.items() if name in forms}
        if not found:
            every = sorted({forms[-1] for forms in names.values()})
            raise UsageError(
                f"The scenario must be one that was run: {', '.join(every)}. Got {name!r} instead."
                f"{did_you_mean(name, every)}"
            )
        chosen |= found
    return chosen


def _within(results: pa.Table, wanted: Sequence[str]) -> pa.Table:
    chosen = matching_scenarios(results["scenario"].unique().to_pylist(), wanted)
    return results.filter(pc.is_in(results["scenario"], pa.array(sorted(chosen))))


def settings_of(folders: Sequence[RunFolder], axis: str) -> dict[str, Setting]:
    """Return scenario → its value of the parameter ``axis``, for the scenarios that have it.

    Raises UsageError if no scenario that was run has it.
    """
    found, axes = {}, {HORIZON}
    for entry in (e for folder in folders for e in folder.manifest.suite["scenarios"]):
        declared = number_parameters(entry)
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
            f"The axis of a curve must be {HORIZON!r}, or a number parameter of a scenario that was"
            f" run: {', '.join(sorted(axes - {HORIZON})) or 'here is none'}. Got {axis!r} instead."
            f"{did_you_mean(axis, sorted(axes))}"
        )
    return found


def number_parameters(entry: Mapping[str, Any]) -> dict[str, Any]:
    """Return the parameters of a manifest's scenario whose values are numbers."""
    declared = entry["config"].get("parameters", {})
    return {
        name: parameter
        for name, parameter in declared.items()
        if not isinstance(parameter["default"], bool | str)
    }


def _installed_metrics(notify: Notify) -> dict[str, Metric]:
    """Every installed metric by name; ``notify`` receives why others cannot be used."""
    metrics, broken = declared_metrics()
    for cause in broken:
        notify(f"{cause} It is left out.")
    return metrics


def _tables(
    folders: Sequence[RunFolder], metrics: Mapping[str, Metric], recompute: bool
) -> list[pa.Table]:
    """The measured values of each run; a label must stand for one navigator in all of them."""
    stored = [encoded_results_of(folder) for folder in folders]
    named = zip(folders, stored, strict=True)
    require_one_navigator_per_label({str(f.shown): results for f, results in named})
    if not recompute:
        return stored
    from benchnav.runner.execute.remeasurement import recomputed

    return [recomputed(folder, list(metrics.values())) for folder in folders]


def _joined(folders: Sequence[RunFolder], tables: Sequence[pa.Table]) -> pa.Table:
    joined = pa.concat_tables(tables, promote_options="default").unify_dictionaries()
    if not len(joined):
        raise StoreError(
            f"There must be episodes to make a table of. {folders[0].shown} holds none."
        )
    return joined


def _held(results: pa.Table, metrics: Mapping[str, Metric]) -> list[str]:
    held = set(results["metric"].unique().to_pylist())
    return [*(name for name in metrics if name in held), *sorted(held - set(metrics))]


def _not_applicable(folder: RunFolder) -> Iterator[NotApplicable]:
    entries = folder.manifest.suite.get("navigators", ())
    asked = {entry["label"]: int(entry.get("rehearsal", 0)) for entry in entries}
    for cell in folder.manifest.cells:
        if cell["reason"]:
            yield NotApplicable(
                entry_of(cell["navigator"]), cell["scenario"], cell["track"], cell["reason"],
                asked.get(cell["navigator"], 0), perception_of(cell),
            )  # fmt: skip
