"""Curves of a metric against a number: success against horizon, or against a parameter."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import groupby
from typing import TYPE_CHECKING

import numpy as np

from benchnav.arena.agents import Role
from benchnav.arrays import FloatArray
from benchnav.leaderboard.statistics.estimate import Sample, columns_of, estimate
from benchnav.leaderboard.statistics.interval import resample
from benchnav.leaderboard.statistics.strata import strata
from benchnav.metrics.metric import Metric
from benchnav.metrics.success import success, success_by_horizon, success_time
from benchnav.navigation.plugin.trainings import entry_of

if TYPE_CHECKING:
    import pyarrow as pa

    from benchnav.episode.episode import Episode

HORIZON = "horizon"
"""The axis that is not a scenario parameter: results if the episodes had ended earlier."""
POINTS = 100  # times of a curve against horizon


@dataclass(frozen=True)
class Point:
    """A point of one navigator's curve."""

    navigator: str
    scenario: str  # without the parameter that is the axis
    track: str
    role: str
    metric: str
    axis: str  # "horizon", or a parameter of the scenario
    axis_unit: str
    x: float
    value: float  # mean over worlds; NaN if undefined in all
    low: float  # of its 95 % interval
    high: float
    unit: str  # of the value
    worlds: int  # attempted
    split: str
    scenario_hash: str
    horizon: float  # [s] of the episodes
    dt: float  # [s]
    rehearsal: int = 0  # rehearsals of each world that the navigator was granted
    perception: str = "exact"


@dataclass(frozen=True)
class Setting:
    """The position on the axis of a scenario with a parameter."""

    scenario: str  # without the parameter
    x: float
    unit: str  # of x; "" if the scenario gives none


@dataclass(frozen=True, eq=False)
class Attempt:
    """The success times of the evaluated agents of one role in one episode."""

    navigator: str
    scenario: str
    track: str
    role: str
    split: str
    scenario_hash: str
    horizon: float  # [s] of the episode
    dt: float  # [s]
    rehearsal: int  # rehearsals granted to the navigator
    seed: int
    times: FloatArray  # (N,) [s] of success; inf without success
    perception: str = "exact"


Key = tuple[str, str, str, str, str, str, float, float, int, str]
Worlds = dict[int, dict[str, FloatArray]]  # seed → label of each training → success times


def attempts_of(episode: Episode) -> Iterator[Attempt]:
    """Yield the attempts of an episode, one for each role. Background agents are left out."""
    identity, clock, agents = episode.identity, episode.world.clock, episode.world.agents
    times = success_time(episode)
    for role in Role:
        members = agents.evaluated & (agents.role == role)
        if members.any():
            yield Attempt(
                identity.navigator, identity.scenario, identity.track, role.name.lower(),
                identity.split, identity.scenario_hash, clock.horizon, clock.dt,
                episode.rehearsals, identity.seed, times[members], identity.perception,
            )  # fmt: skip


def horizon_curves(episodes: Iterable[Episode], points: int = POINTS) -> tuple[Point, ...]:
    """Return success against horizon at ``points`` even times, from complete episodes.

    The cumulative incidence of success: agents that collided, failed or timed out stay in the
    denominator. There is one curve for each navigator × scenario × condition × role, and
    separate ones for each split, scenario hash, horizon, time step or number of rehearsals. A
    repeated episode counts once. Background agents are left out.
    """
    return curves_of((a for episode in episodes for a in attempts_of(episode)), points)


def curves_of(attempts: Iterable[Attempt], points: int = POINTS) -> tuple[Point, ...]:
    """Return the same curves from the attempts of the episodes."""
    curves: dict[Key, Worlds] = {}
    for a in attempts:
        key = (
            a.split, a.track, a.perception, a.scenario, a.role, a.scenario_hash, a.horizon, a.dt,
            a.rehearsal, entry_of(a.navigator),
        )  # fmt: skip
        curves.setdefault(key, {}).setdefault(a.seed, {})[a.navigator] = a.times
    return tuple(p for key in sorted(curves) for p in _horizon_curve(key, curves[key], points))


def _times(horizon: float, points: int) -> FloatArray:
    """Return the ends (T,) [s] of equal parts of the episode."""
    found: FloatArray = np.linspace(0.0, horizon, points + 1)[1:]
    return found


def _horizon_curve(key: Key, worlds: Worlds, points: int) -> Iterator[Point]:
    split, track, perception, scenario, role, digest, horizon, dt, rehearsal, navigator = key
    times = [np.concatenate([*worlds[seed].values()]) for seed in sorted(worlds)]
    every = np.array([success_by_horizon(each, _times(horizon, points)) for each in times])
    value, places = np.unique(every, axis=1, return_inverse=True)  # few times differ
    agents = np.repeat([[float(len(each))] for each in times], value.shape[1], axis=1)
    counts = resample(len(value), np.random.default_rng(0))
    found = estimate(Sample(value, agents, counts), columns_of([success] * value.shape[1]))
    for k, time in zip(places.ravel().tolist(), _times(horizon, points), strict=True):
        yield Point(
            navigator, scenario, track, role, success.name, HORIZON, "s", float(time),
            float(found.value[k]), float(found.low[k]), float(found.high[k]), "", len(value),
            split, digest, horizon, dt, rehearsal, perception,
        )  # fmt: skip


def parameter_curves(
    results: pa.Table, metric: Metric, axis: str, settings: Mapping[str, Setting]
) -> tuple[Point, ...]:
    """Return a metric against the parameter ``axis`` of scenarios.

    ``settings`` maps a scenario of ``results`` (RESULTS) with this parameter to its position
    on the axis; other scenarios are left out.
    """
    found = []
    for s in strata(results, {metric.name: metric}):
        if s.scenario not in settings or metric.name not in s.metrics:
            continue
        m = s.metrics.index(metric.name)
        sample = Sample(s.value[:, :, m], s.agents[:, :, m], resample(len(s.seeds), s.rng("curve")))
        mean = estimate(sample, columns_of([metric] * len(s.navigators)))
        where = settings[s.scenario]
        found += [
            Point(
                navigator, where.scenario, s.track, s.role, metric.name, axis, where.unit, where.x,
                float(mean.value[n]), float(mean.low[n]), float(mean.high[n]), metric.unit,
                int(s.attempted[:, n].sum()), s.split, s.scenario_hash, s.horizon, s.dt,
                s.rehearsal, s.perception,
            )
            for n, navigator in enumerate(s.navigators)
        ]  # fmt: skip
    return tuple(sorted(found, key=lambda p: (*place(p), p.navigator, p.x)))


Place = tuple[str, str, str, str, str, float, float, int]


def place(p: Point) -> Place:
    """Return the key of a picture: curves of one scenario, condition and role share one."""
    return p.split, p.scenario, p.track, p.perception, p.role, p.horizon, p.dt, p.rehearsal


def panels(points: Iterable[Point]) -> Iterator[list[Point]]:
    """Yield the points of each picture."""
    for _, group in groupby(sorted(points, key=lambda p: (*place(p), p.navigator, p.x)), key=place):
        yield list(group)
