"""The measurement of new or stored episodes: a table of values."""

from collections.abc import Iterable, Sequence

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from benchnav.episode.episode import Episode
from benchnav.metrics.measure import Cell, measure_roles
from benchnav.metrics.metric import NOT_APPLICABLE, Metric
from benchnav.navigation.command_check import kind_of
from benchnav.store.parts.results import RESULTS
from benchnav.store.runs.reading import episodes_of, in_every_track
from benchnav.store.runs.run_folder import RunFolder
from benchnav.store.runs.run_path import RunPath


def measured(episodes: Iterable[Episode], metrics: Sequence[Metric]) -> pa.Table:
    """Return the table of `RESULTS` of these episodes: by episode, by role, in order of metrics."""
    roles = [role for episode in episodes for role in measure_roles(episode, metrics)]
    cells = [cell for _, of_role in roles for cell in of_role]
    owner = np.repeat(np.arange(len(roles)), len(metrics))
    columns = {"metric": [metric.name for metric in metrics] * len(roles)}
    columns |= {name: [getattr(cell, name) for cell in cells] for name in Cell._fields}
    arrays = []
    for field in RESULTS:
        if field.name in columns:
            arrays.append(pa.array(columns[field.name], field.type))
        else:
            common = pa.array([common[field.name] for common, _ in roles], field.type)
            arrays.append(common.take(pa.array(owner)))
    return pa.Table.from_arrays(arrays, schema=RESULTS)


def failed_metrics(results: pa.Table) -> list[tuple[str, str]]:
    """Return (metric, reason) for each value of `RESULTS` that is missing after a failure."""
    gaps = results.filter(pc.not_equal(results["missing"], ""))
    inapplicable = pc.starts_with(gaps["missing"].cast("string"), NOT_APPLICABLE)
    gaps = gaps.filter(pc.invert(inapplicable))
    return list(zip(gaps["metric"].to_pylist(), gaps["missing"].to_pylist(), strict=True))


def tracebacks_of(results: pa.Table) -> dict[str, str]:
    """Return tracebacks of metrics that raised, one for each kind of reason."""
    raised = results.filter(pc.is_valid(results["traceback"]))
    reasons, texts = raised["missing"].to_pylist(), raised["traceback"].to_pylist()
    return {kind_of(why): text for why, text in zip(reasons, texts, strict=True) if text}


def measure_again(run: RunPath, metrics: Sequence[Metric]) -> pa.Table:
    """Return the table of `RESULTS` of a stored run, computed from its stored episodes.

    An episode that is valid for several tracks has rows for each of them.

    Raises as `benchnav.store.runs.reading.read_episodes`.
    """
    return measured_of(RunFolder.open(run), metrics)


def measured_of(run: RunFolder, metrics: Sequence[Metric]) -> pa.Table:
    """Return the same table as `measure_again`, of an open run."""
    return in_every_track(measured(episodes_of(run), metrics), run.manifest)
