"""The measurement of new or stored episodes: a table of values."""

from collections.abc import Iterable, Sequence

import pyarrow as pa
import pyarrow.compute as pc

from benchnav.episode.episode import Episode
from benchnav.metrics.measure import measure
from benchnav.metrics.metric import Metric
from benchnav.navigation.command_check import kind_of
from benchnav.store.parts.results import RESULTS
from benchnav.store.runs.reading import episodes_of, in_every_track
from benchnav.store.runs.run_folder import RunFolder
from benchnav.store.runs.run_path import RunPath


def measured(episodes: Iterable[Episode], metrics: Sequence[Metric]) -> pa.Table:
    """Return the table of `RESULTS` of these episodes."""
    rows = [row for episode in episodes for row in measure(episode, metrics)]
    return pa.Table.from_pylist(rows, schema=RESULTS)


def failed_metrics(results: pa.Table) -> list[tuple[str, str]]:
    """Return (metric, reason) for each value of `RESULTS` that is missing after a failure."""
    gaps = results.filter(pc.not_equal(results["missing"], ""))
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
