"""Compute the rows of the results table from episodes."""

import math
from collections.abc import Sequence
from functools import cache
from typing import Any

from benchnav.arena.agents import Role
from benchnav.arrays import BoolArray
from benchnav.episode.episode import Episode
from benchnav.errors import PluginError
from benchnav.metrics.metric import Metric, evaluate
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
    _no_metrics_twice(tuple(metric.name for metric in metrics))
    return [
        {**common, **valued(metric, episode, members)}
        for common, members in subjects(episode)
        for metric in metrics
    ]


def subjects(episode: Episode) -> list[tuple[dict[str, Any], BoolArray]]:
    """Return (common columns, members (A,)) of each evaluated role of an episode."""
    agents, identity, clock = episode.world.agents, episode.identity, episode.world.clock
    found: list[tuple[dict[str, Any], BoolArray]] = []
    for role in Role:
        members = agents.evaluated & (agents.role == role)
        if not members.any():
            continue
        common = {
            "navigator": identity.navigator, "scenario": identity.scenario,
            "scenario_hash": identity.scenario_hash, "track": identity.track,
            "split": identity.split, "seed": identity.seed, "role": role.name.lower(),
            "agents": int(members.sum()),
            "failure": episode.failure, "horizon": clock.horizon, "dt": clock.dt,
            "navigator_hash": identity.navigator_hash, "rehearsal": episode.rehearsals,
            "source_hash": identity.source_hash,
            "rehearsal_decisions": episode.rehearsal_decisions,
            "rehearsal_seconds": episode.timings.rehearsal, "remarks": list(episode.remarks),
        }  # fmt: skip
        found.append((common, members))
    return found


def valued(metric: Metric, episode: Episode, members: BoolArray) -> dict[str, Any]:
    """Return the columns of a row that depend on the metric."""
    value, defined, missing, traceback = math.nan, 0, "", None
    try:
        value, defined = evaluate(metric, episode, members)
    except (Exception, SystemExit) as error:
        if type(error).__module__ == "numba.core.errors" and is_own(metric.name):
            raise  # a kernel of ours does not compile: this is no property of the episode
        missing, traceback = exception_text(error), trace(error)
    return {
        "metric": metric.name, "value": value, "defined": defined,
        "missing": missing, "traceback": traceback,
    }  # fmt: skip
