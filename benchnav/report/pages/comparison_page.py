"""The page that compares any two navigators of a report."""

from __future__ import annotations

import json
import math
import shlex
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

from benchnav.leaderboard.from_runs import COMPARED
from benchnav.leaderboard.record import ALL
from benchnav.leaderboard.rendering.prose import over_trainings, training_sentences
from benchnav.leaderboard.statistics.all_pairs import duels, notes_by_condition
from benchnav.leaderboard.statistics.head_to_head import Duel
from benchnav.navigation.plugin.trainings import entries_of
from benchnav.report.analysis.best import more_seeds
from benchnav.report.analysis.pair_codec import VERDICTS, PairCodec, metric_fields
from benchnav.report.figure import plain
from benchnav.report.page import ASSETS, COMPARISON, Page, href
from benchnav.report.report_data import ReportData
from benchnav.report.template import fill
from benchnav.scenario.condition import condition
from benchnav.text.visible import visible

if TYPE_CHECKING:
    import pyarrow as pa
    from markupsafe import Markup

SCRIPT = "comparison.js"  # in report/assets


def pages(data: ReportData) -> Iterator[Page]:
    """Yield the page with the comparisons of every two navigators."""
    values = data.values
    compared = [m for m in COMPARED if m in values.metrics and m in values.names]
    metrics = compared or [m for m in data.metrics if m in values.metrics][:4]
    codec = PairCodec(metrics)
    labels = sorted(entries_of(values.results["navigator"].unique().to_pylist()))
    shown = values.results.filter(_named(values.results, metrics))
    notes = notes_by_condition(shown, values.metrics, data.conditions, values.not_applicable)
    pairs = []
    trained = {name for name, facts in values.facts.items() if "training" in facts}
    for duel in duels(values.results, values.metrics, metrics, values.not_applicable, trained):
        key = f"pair-{labels.index(duel.first)}-{labels.index(duel.second)}"
        texts = [
            [*found, *_of_trainings(data, duel, where)]
            for found, where in zip(notes[duel.first, duel.second], data.conditions, strict=True)
        ]
        pairs.append((key, _json(codec.pair(duel, texts))))
    runs = [str(folder.shown) for folder in data.folders]
    shared = {
        "navigators": [_navigator(data, label) for label in labels],
        "metrics": [metric_fields(values.metrics[name]) for name in metrics],
        "places": list(codec.places),
        "verdicts": VERDICTS,
        "tracks": [condition(*each) for each in data.conditions],
        "runs": runs,
    }
    body = fill(
        "comparison.html", page=COMPARISON, several=len(labels) > 1, runs=shlex.join(runs),
        is_exact=data.is_exact, more=list(more_seeds(data.folders)),
        shared=_json(shared), pairs=pairs, script=href(COMPARISON, ASSETS / SCRIPT),
    )  # fmt: skip
    yield Page(COMPARISON, "Two navigators compared", body, COMPARISON, has_figures=True)


def _of_trainings(data: ReportData, duel: Duel, where: tuple[str, str]) -> Iterator[str]:
    """Yield sentences about the trainings of two entries under one condition."""
    for c in duel.comparisons:
        if (c.track, c.perception) == where and not math.isnan(c.training_low):
            metric = data.values.metrics[c.metric]
            place = "over all scenarios" if c.scenario == ALL else f"in {c.scenario}"
            yield f"{metric.name} {place}: {over_trainings(c, metric)}"
            yield from training_sentences(c, metric)


def _named(results: pa.Table, metrics: Sequence[str]) -> pa.ChunkedArray:
    """Return a mask of the results of some metrics."""
    import pyarrow as pa
    import pyarrow.compute as pc

    return pc.is_in(results["metric"], value_set=pa.array(metrics, pa.string()))


def _navigator(data: ReportData, label: str) -> dict[str, str]:
    style = data.styles[label]
    return {
        "name": visible(label), "shown": plain(label), "color": style.color,
        "symbol": style.symbol,
    }  # fmt: skip


def _json(fields: Any) -> Markup:
    """Return JSON that may stand in a script element."""
    from markupsafe import Markup

    text = json.dumps(fields, separators=(",", ":"), ensure_ascii=False)
    return Markup(text.replace("<", "\\u003c"))  # noqa: S704
