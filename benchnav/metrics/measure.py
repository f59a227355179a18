"""Episodes in, rows of the results table out."""

import math
from collections.abc import Sequence
from functools import cache
from typing import Any

from benchnav.arena.agents import Role
from benchnav.arrays import BoolArray
from benchnav.episode.episode import Episode
from benchnav.errors import PluginError
from benchnav.metrics.metric import Metric, evaluate
from benchnav.navigation.command_check import said
from benchnav.navigation.plugin.trace import trace
from benchnav.plugins import METRICS


def load_metric(name: str) -> Metric:
    """The registered metric of this name. Raises what the registry raises."""
    metric: Metric = METRICS.load(name)
    return metric


def own_metrics() -> tuple[Metric, ...]:
    """Return the metrics of benchnav itself, by name, without importing plugins."""
    return tuple(load_metric(name) for name in METRICS.names() if is_own(name))


def is_own(name: str) -> bool:
    """Whether the metric of this name is part of benchnav, and not of a plugin."""
    return METRICS.source(name).is_own and not METRICS.is_local(name)


def all_metrics() -> tuple[Metric, ...]:
    """Every registered metric, by name."""
    return tuple(load_metric(name) for name in METRICS.names())


@cache
def _no_metrics_twice(names: tuple[str, ...]) -> None:
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise PluginError(f"Metrics must have different names. Got {', '.join(twice)} twice.")


def measure(episode: Episode, metrics: Sequence[Metric]) -> list[dict[str, Any]]:
    """Rows of `benchnav.store.parts.results.RESULTS`: each metric for each role that is evaluated.

    Background agents are in the world, but never scored. A metric that raises or answers
    another shape costs its own value: it is missing (NaN), with the reason.
    """
    _no_metrics_twice(tuple(metric.name for metric in metrics))
    return [
        {**common, **valued(metric, episode, members)}
        for common, members in subjects(episode)
        for metric in metrics
    ]


def subjects(episode: Episode) -> list[tuple[dict[str, Any], BoolArray]]:
    """(what rows say of it, members (A,)) of each role that is evaluated in an episode."""
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
    """The columns of a row that a metric fills."""
    value, defined, missing, traceback = math.nan, 0, "", None
    try:
        value, defined = evaluate(metric, episode, members)
    except (Exception, SystemExit) as error:
        missing, traceback = said(error), trace(error)
    return {
        "metric": metric.name, "value": value, "defined": defined,
        "missing": missing, "traceback": traceback,
    }  # fmt: skip
