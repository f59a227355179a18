"""Runs → the text of a table, a comparison or a curve. Imported once a verb needs it."""

from collections.abc import Collection, Iterator, Sequence

import pyarrow as pa
import pyarrow.compute as pc

from benchnav.errors import StoreError
from benchnav.leaderboard.curve import render_curves
from benchnav.leaderboard.duel import duel, render_duel
from benchnav.leaderboard.label import require_one_navigator_per_label
from benchnav.leaderboard.layout import choose
from benchnav.leaderboard.record import NotApplicable
from benchnav.leaderboard.render import render
from benchnav.leaderboard.table import leaderboard
from benchnav.metrics.measure import all_metrics
from benchnav.metrics.metric import Metric
from benchnav.store.reading import read_episodes_in_every_track, read_results
from benchnav.store.run_folder import RunFolder

TIDY = ("csv", "json")  # hold every metric unless told otherwise


def table(
    folders: Sequence[RunFolder],
    format: str,
    metric: Sequence[str] | None,
    recompute: bool,
    verified: Collection[str] = (),
) -> str:
    """The leaderboard; only what is shown is computed. ``verified`` are labels to be marked."""
    metrics = _metrics()
    results = _results(folders, metrics, recompute)
    held = _held(results, metrics)
    shown = choose(held, ["all"] if metric is None and format in TIDY else metric)
    results = results.filter(pc.is_in(results["metric"], pa.array(shown)))
    missing = [gap for folder in folders for gap in _not_applicable(folder)]
    learned = {label: cost for folder in folders for label, cost in _training(folder)}
    made = leaderboard(results, metrics, missing, learned, verified)
    return render(made, format, shown)


def comparison(
    folders: Sequence[RunFolder],
    format: str,
    pair: tuple[str, str],
    metric: Sequence[str],
    recompute: bool,
) -> str:
    """Two navigators against each other."""
    metrics = _metrics()
    results = _results(folders, metrics, recompute)
    names = choose(_held(results, metrics), metric)
    found = [c for name in names for c in duel(results, metrics, name, *pair)]
    return render_duel(found, metrics, format)


def curve(folders: Sequence[RunFolder], format: str) -> str:
    """Success against time, from the stored episodes."""
    _results(folders, {}, recompute=False)  # refuses what must not be merged
    return render_curves((e for f in folders for e in read_episodes_in_every_track(f.path)), format)


def _metrics() -> dict[str, Metric]:
    return {metric.name: metric for metric in all_metrics()}


def _results(folders: Sequence[RunFolder], metrics: dict[str, Metric], recompute: bool) -> pa.Table:
    """Measured values of all runs, in which a label must stand for one navigator."""
    stored = {str(f.shown): read_results(f.path) for f in folders}
    require_one_navigator_per_label(stored)
    tables = list(stored.values())
    if recompute:
        from benchnav.runner.measured import measure_again

        tables = [measure_again(f.path, list(metrics.values())) for f in folders]
    joined = pa.concat_tables(tables, promote_options="default")
    if not len(joined):
        raise StoreError(
            f"There must be episodes to make a table of. {folders[0].shown} holds none."
        )
    return joined


def _held(results: pa.Table, metrics: dict[str, Metric]) -> list[str]:
    """The metrics of some results, in the order of their definitions."""
    held = set(results["metric"].unique().to_pylist())
    return [*(name for name in metrics if name in held), *sorted(held - set(metrics))]


def _training(folder: RunFolder) -> Iterator[tuple[str, tuple[float, float]]]:
    """(label, (decisions, seconds)) of the navigators that learned."""
    for entry in folder.manifest.suite.get("navigators", ()):
        if "training" in entry:
            yield entry["label"], (entry["training"]["decisions"], entry["training"]["seconds"])


def _not_applicable(folder: RunFolder) -> Iterator[NotApplicable]:
    entries = folder.manifest.suite.get("navigators", ())
    asked = {entry["label"]: int(entry.get("rehearsal", 0)) for entry in entries}
    for cell in folder.manifest.cells:
        if cell["reason"]:
            yield NotApplicable(
                cell["navigator"], cell["scenario"], cell["track"], cell["reason"],
                asked.get(cell["navigator"], 0),
            )  # fmt: skip
