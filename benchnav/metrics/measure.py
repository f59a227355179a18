"""Compute the rows of the results table from episodes."""

import math
from collections.abc import Sequence
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from benchnav.arena.agents import Role
from benchnav.arrays import LARGEST, BoolArray, FloatArray, IntArray
from benchnav.episode.episode import Episode
from benchnav.errors import PluginError
from benchnav.kernels import kernel
from benchnav.metrics.metric import NOT_APPLICABLE, Metric, evaluate
from benchnav.metrics.quantities.numpy_sum import numpy_sum
from benchnav.navigation.command_check import exception_text
from benchnav.navigation.plugin.trace import trace
from benchnav.plugins import METRICS


def load_metric(name: str) -> Metric:
    """Return the registered metric of this name. Raises the errors of the registry."""
    metric: Metric = METRICS.load(name)
    return metric


def own_metrics() -> tuple[Metric, ...]:
    """Return the metrics of benchnav itself, by name, without importing plugins."""
    return tuple(load_metric(name) for name in METRICS.names() if is_own(name))


def is_own(name: str) -> bool:
    """Whether the metric of this name belongs to benchnav, and not to a plugin."""
    return METRICS.source(name).is_own and not METRICS.is_local(name)


def all_metrics() -> tuple[Metric, ...]:
    """Return every registered metric, by name."""
    return tuple(load_metric(name) for name in METRICS.names())


@cache
def _no_metrics_twice(names: tuple[str, ...]) -> None:
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise PluginError(f"Metrics must have different names. Got {', '.join(twice)} twice.")


def measure(episode: Episode, metrics: Sequence[Metric]) -> list[dict[str, Any]]:
    """Return rows of `benchnav.store.parts.results.RESULTS`: each metric for each evaluated role.

    Background agents are in the world, but never scored. If a metric raises or returns another
    shape, only its own value is missing (NaN), with the reason.
    """
    return [
        {**common, "metric": metric.name, **cell._asdict()}
        for common, cells in measure_roles(episode, metrics)
        for metric, cell in zip(metrics, cells, strict=True)
    ]


class Cell(NamedTuple):
    """The columns of a row that depend on the metric's function."""

    value: float = math.nan
    defined: int = 0
    missing: str = ""
    traceback: str | None = None


def _inapplicable(metric: Metric, episode: Episode) -> str:
    """Return what a metric needs that an episode does not have; "" if it has all."""
    if metric.people and not episode.world.has_people:
        return "needs people"
    return _undisturbed_gap(episode) if metric.undisturbed else ""


def _undisturbed_gap(episode: Episode) -> str:
    if not len(episode.world.people[0]):
        return "needs people who react: recorded people without a driver do not"
    other = episode.undisturbed() if episode.undisturbed is not None else None
    if other is None:
        return "needs the undisturbed world: key `undisturbed` of the suite"
    return f"the undisturbed world failed: {other.failure}" if other.failure else ""


def measure_roles(
    episode: Episode, metrics: Sequence[Metric]
) -> list[tuple[dict[str, Any], list[Cell]]]:
    """Return (common columns, a cell for each metric) of each evaluated role.

    The means over agents of all metrics are taken together.
    """
    _no_metrics_twice(tuple(metric.name for metric in metrics))
    rows = np.full((len(metrics), len(episode.world.agents)), math.nan)
    alone = [n for n, metric in enumerate(metrics) if not _agents_values(metric, episode, rows[n])]
    gaps = {n: why for n, m in enumerate(metrics) if (why := _inapplicable(m, episode))}
    found = []
    for common, members in subjects(episode):
        means, defined = np.empty(len(metrics)), np.empty(len(metrics), np.int64)
        write_means(rows, np.array(members), means, defined)
        cells = list(map(Cell, means.tolist(), defined.tolist()))
        for n in (*alone, *np.flatnonzero(np.abs(means) > LARGEST).tolist()):
            cells[n] = measure_alone(metrics[n], episode, members)
        for n, why in gaps.items():
            cells[n] = Cell(missing=NOT_APPLICABLE + why)
        found.append((common, cells))
    return found


def _agents_values(metric: Metric, episode: Episode, values: FloatArray) -> bool:
    """Write the values (A,) of an agent's metric; False if the metric must be measured alone.

    These are metrics of groups, and metrics that raise or return anything but floats (A,).
    """
    if metric.scope == "group":
        return False
    try:
        found = metric.function(episode)
    except (Exception, SystemExit):
        return False  # it raises again when it is measured alone
    if type(found) is not np.ndarray or found.dtype != float or found.shape != values.shape:
        return False
    values[:] = found
    return True


@kernel
def write_means(
    values: FloatArray, members: BoolArray, mean: FloatArray, defined: IntArray
) -> None:
    """Write the mean and the number of the members (A,) with a defined value, of N metrics (N, A).

    The mean is that of `benchnav.metrics.metric.evaluate`, bit for bit.
    """
    known = np.empty(values.shape[1])
    for n in range(values.shape[0]):
        count = 0
        for a in range(values.shape[1]):
            if members[a] and values[n, a] == values[n, a]:
                known[count] = values[n, a]
                count += 1
        mean[n], defined[n] = math.nan, count
        if count > 0:
            mean[n] = numpy_sum(known[:count]) / count


_ROLES = tuple((int(role), role.name.lower()) for role in Role)


def subjects(episode: Episode) -> list[tuple[dict[str, Any], BoolArray]]:
    """Return (common columns, members (A,)) of each evaluated role of an episode."""
    agents, identity, clock = episode.world.agents, episode.identity, episode.world.clock
    found: list[tuple[dict[str, Any], BoolArray]] = []
    evaluated = agents.evaluated
    for role, name in _ROLES:
        members = evaluated & (agents.role == role)
        count = int(np.count_nonzero(members))
        if not count:
            continue
        common = {
            "navigator": identity.navigator, "scenario": identity.scenario,
            "scenario_hash": identity.scenario_hash, "track": identity.track,
            "perception": identity.perception,
            "split": identity.split, "seed": identity.seed, "role": name,
            "agents": count,
            "failure": episode.failure, "horizon": clock.horizon, "dt": clock.dt,
            "navigator_hash": identity.navigator_hash, "rehearsal": episode.rehearsals,
            "source_hash": identity.source_hash,
            "rehearsal_decisions": episode.rehearsal_decisions,
            "rehearsal_seconds": episode.timings.rehearsal, "remarks": list(episode.remarks),
        }  # fmt: skip
        found.append((common, members))
    return found


def measure_alone(metric: Metric, episode: Episode, members: BoolArray) -> Cell:
    """Return the cell of one metric for members (A,)."""
    try:
        return Cell(*evaluate(metric, episode, members))
    except (Exception, SystemExit) as error:
        if type(error).__module__ == "numba.core.errors" and is_own(metric.name):
            raise  # a kernel of ours does not compile: this is no property of the episode
        return Cell(missing=exception_text(error), traceback=trace(error))
