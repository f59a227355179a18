"""The remeasurement of stored episodes, with metrics of plugins in separate processes."""

from collections.abc import Iterator, Sequence
from itertools import islice
from pathlib import Path
from typing import Any

import pyarrow as pa
from pydantic import TypeAdapter, ValidationError

from benchnav.episode.episode import Episode
from benchnav.errors import BenchnavError
from benchnav.metrics.measure import is_own, load_metric, measure
from benchnav.metrics.metric import Metric
from benchnav.navigation.command_check import short
from benchnav.navigation.plugin.plugin_process import (
    IMPORT,
    MEASURING,
    Plugin,
    StepCallback,
    query_plugins,
    serve,
)
from benchnav.plugins import METRICS
from benchnav.processes.channel import Channel
from benchnav.runner.execute.measurement import measured_of
from benchnav.store.parts.results import RESULTS
from benchnav.store.runs.reading import episodes_of, in_every_track
from benchnav.store.runs.run_folder import RunFolder

_BATCH = 128  # episodes per request
_TIMEOUT = 120.0  # [s] per request
_VALUES = TypeAdapter(list[tuple[float, int, str]])  # value, defined, missing
_Row = dict[str, Any]


def recomputed(run: RunFolder, metrics: Sequence[Metric]) -> pa.Table:
    """Return the same table as `measured_of`, with metrics of plugins in other processes.

    A metric that is registered only in this process runs in this process.
    """
    here = [metric for metric in metrics if METRICS.is_local(metric.name) or is_own(metric.name)]
    away = [metric.name for metric in metrics if metric not in here]
    if not away or not here:
        return measured_of(run, here)
    rows: list[_Row] = []
    like: list[list[_Row]] = []  # for each batch of episodes, the rows of one metric
    for batch in _batches(run):
        fresh = [row for episode in batch for row in measure(episode, here)]
        like.append([row for row in fresh if row["metric"] == here[0].name])
        rows += fresh
    groups = [
        [
            Plugin(
                METRICS.kind, name, "", {"run": str(run.path.absolute()), "batch": k, "name": name}
            )
            for k in range(len(like))
        ]
        for name in away
    ]
    answers = query_plugins(f"{__name__}:serve_values", groups, _TIMEOUT)
    for group, answered in zip(groups, answers, strict=True):
        for plugin, answer, batch_rows in zip(group, answered, like, strict=True):
            rows += _rows(plugin, answer, batch_rows)
    return in_every_track(pa.Table.from_pylist(rows, schema=RESULTS), run.manifest)


def _batches(run: RunFolder) -> Iterator[list[Episode]]:
    episodes = iter(episodes_of(run))
    while batch := list(islice(episodes, _BATCH)):
        yield batch


def _rows(plugin: Plugin, answer: Any, like: Sequence[_Row]) -> list[_Row]:
    """Return the rows of a metric; values are missing if its process failed."""
    missing = str(answer) if isinstance(answer, BenchnavError) else ""
    values: list[tuple[float, int, str]] = []
    if not missing:
        try:
            values = _VALUES.validate_python(answer)
        except ValidationError:
            missing = str(plugin.broken("it must answer values"))
        if len(values) != len(like):
            missing = str(plugin.broken(f"it answered {len(values)} values for {len(like)}"))
    if missing:
        values = [(float("nan"), 0, missing)] * len(like)
    return [
        {
            **row, "metric": plugin.name, "value": value, "traceback": None,
            "defined": min(max(defined, 0), row["agents"]), "missing": short(why) if why else "",
        }
        for row, (value, defined, why) in zip(like, values, strict=True)
    ]  # fmt: skip


def serve_values(channel: Channel, notes: "memoryview[float]") -> None:
    """Run as a separate process: measure the episodes that the channel requests."""
    kept: dict[str, Any] = {"next": 0}

    def values(question: Any, on_step: StepCallback) -> list[tuple[float, int, str]]:
        on_step(IMPORT)
        metric = load_metric(question["name"])
        on_step(MEASURING)
        batches = kept.setdefault("batches", _batches(RunFolder.open(Path(question["run"]))))
        while kept["next"] <= question["batch"]:
            batch = next(batches)
            kept["next"] += 1
        rows = [row for episode in batch for row in measure(episode, [metric])]
        return [(row["value"], row["defined"], row["missing"]) for row in rows]

    serve(channel, notes, values)
