"""Build a leaderboard from results."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from typing import TYPE_CHECKING, Any

import numpy as np

from benchnav.arrays import BoolArray, FloatArray
from benchnav.leaderboard.caveats import with_caveats
from benchnav.leaderboard.label import require_one_navigator_per_label
from benchnav.leaderboard.metric_faults import faults, with_fault
from benchnav.leaderboard.record import (
    ALL,
    ALL_INTERQUARTILE,
    PRICES,
    Leaderboard,
    NotApplicable,
    Record,
)
from benchnav.leaderboard.remarks import failures, remarks, with_texts
from benchnav.leaderboard.statistics.estimate import (
    Estimate,
    Sample,
    columns_of,
    estimate,
    interquartile_mean_over,
    mean_over,
)
from benchnav.leaderboard.statistics.interval import resample
from benchnav.leaderboard.statistics.price import prices
from benchnav.leaderboard.statistics.ranking import Standing, standings
from benchnav.leaderboard.statistics.strata import Stratum, align, strata
from benchnav.leaderboard.statistics.trainings import Spread, spread_of, with_entries
from benchnav.metrics.metric import Metric
from benchnav.runner.plan.installed_differences import Caveat

if TYPE_CHECKING:
    import pyarrow as pa

MIDDLE_HALF = 4  # smallest number of scenarios for which it differs from the mean


def leaderboard(
    results: pa.Table,
    metrics: Mapping[str, Metric],
    not_applicable: Sequence[NotApplicable] = (),
    training: Mapping[str, tuple[float, float]] = {},
    verified: Collection[str] = (),
    mapless: Collection[str] = (),
    modes: Mapping[str, str] = {},
    caveats: Sequence[Caveat] = (),
) -> Leaderboard:
    """Return every navigator × scenario × track × perception × role × metric, with rank.

    Entries that were granted different numbers of rehearsals are never ranked together.
    ``results`` has the schema `benchnav.store.parts.results.RESULTS` and may join several
    runs, with rows in any order. ``metrics`` maps names to definitions;
    a metric without a definition is shown but not ranked. ``not_applicable`` are cells that
    were not run. ``training`` maps labels to the decisions and seconds of their training;
    ``verified`` are the labels whose runs were verified here, ``mapless`` those of navigators that
    use no map. If there are results of both sides of a price (`PRICES`), such as the tracks known
    and unknown, it is a record too. ``modes`` maps labels to the mode in which they ran;
    ``caveats`` are attached to the records that they are about.
    The trainings of an entry are one navigator (`benchnav.navigation.plugin.trainings`), also in
    the arguments about navigators.
    Raises UsageError if one label is used for two navigators, or has two values in one world.
    """
    require_one_navigator_per_label({"the results": results})
    records: list[Record] = []
    found = strata(results, metrics)
    found.sort(key=_contest)  # stable
    for _, group in groupby(found, key=_contest):
        aligned = align(list(group))
        records += _group(aligned, metrics)
        records += _missing(aligned, _belonging(aligned, found, not_applicable), metrics)
    records += prices(found, metrics, mapless, not_applicable)
    results = with_entries(results)
    failed = faults(results)
    records = [with_fault(_with_training(record, training), failed) for record in records]
    texts = failures(results), remarks(results)
    records = [with_texts(record, *texts) for record in records]
    records = [replace(r, verified=_is_verified(r, verified, metrics)) for r in records]
    records = [replace(record, mode=modes.get(record.navigator, "")) for record in records]
    records = [with_caveats(record, caveats) for record in records]
    order = {name: place for place, name in enumerate(metrics)}
    names = sorted(
        {r.metric for r in records}, key=lambda name: (order.get(name, len(order)), name)
    )
    texts_below = tuple(dict.fromkeys(caveat.text for caveat in caveats))
    return Leaderboard(tuple(sorted(records, key=_place(names))), tuple(names), texts_below)


def _with_training(record: Record, training: Mapping[str, tuple[float, float]]) -> Record:
    if record.navigator not in training:
        return record
    decisions, seconds = training[record.navigator]
    return replace(record, training_decisions=decisions, training_seconds=seconds)


def _is_verified(r: Record, verified: Collection[str], metrics: Mapping[str, Metric]) -> bool:
    """Whether a record is verified: not a timing, nor a value whose metric is not installed."""
    known = r.metric in metrics and metrics[r.metric].verifiable
    return known and r.navigator in verified and r.episodes > 0


def _contest(s: Stratum) -> tuple[str, str, str, str, int]:
    """Return the key of records that are ranked together, or averaged over scenarios."""
    return s.split, s.track, s.perception, s.role, s.rehearsal


def _belonging(
    group: list[Stratum], found: list[Stratum], cells: Sequence[NotApplicable]
) -> list[NotApplicable]:
    """Return the cells of entries with the grant of the group, or with a grant without episodes."""
    grants = {s.rehearsal for s in found}
    return [c for c in cells if c.rehearsal == group[0].rehearsal or c.rehearsal not in grants]


@dataclass(frozen=True, eq=False)
class _Body:
    """The values of one scenario, or of all: n worlds, N × M columns."""

    scenario: str
    stratum: Stratum  # gives split, condition, role and the axes
    value: FloatArray  # (n, N, M)
    attempted: BoolArray  # (n, N)
    failed: BoolArray  # (n, N)
    cost: FloatArray  # (n, N, 2) of rehearsals
    found: Estimate  # (N·M,)
    places: list[list[Standing]]  # [metric][navigator]
    single: bool  # False for aggregates over scenarios
    scenarios: Sequence[Stratum]


def _group(group: list[Stratum], metrics: Mapping[str, Metric]) -> Iterator[Record]:
    """Yield the records of strata with one split, condition and role, then those over all."""
    known = [metrics.get(name) for name in group[0].metrics]
    column = columns_of(known * len(group[0].navigators))  # navigator by navigator
    samples = [_sample(s) for s in group]
    parts = [estimate(sample, column) for sample in samples]
    for s, part in zip(group, parts, strict=True):
        same = np.zeros(len(s.seeds), dtype=np.int64)
        places = standings(s.value, s.attempted, same, s.metrics, metrics)
        yield from _records(
            _Body(s.scenario, s, s.value, s.attempted, s.failed, s.cost, part, places, True, [s]),
            metrics,
        )
    if len(group) < 2:
        return
    value = np.concatenate([s.value for s in group])
    attempted = np.concatenate([s.attempted for s in group])
    failed = np.concatenate([s.failed for s in group])
    cost = np.concatenate([s.cost for s in group])
    stratum = np.repeat(np.arange(len(group)), [len(s.seeds) for s in group])
    places = standings(value, attempted, stratum, group[0].metrics, metrics)
    whole = mean_over(parts, samples, column)
    body = _Body(ALL, group[0], value, attempted, failed, cost, whole, places, False, group)
    yield from _records(body, metrics)
    if len(group) >= MIDDLE_HALF:
        middle = interquartile_mean_over(samples)
        never = Standing(None, None, 0, "the mean over scenarios ranks")
        unranked = [[never] * len(row) for row in places]
        yield from _records(
            replace(body, scenario=ALL_INTERQUARTILE, found=middle, places=unranked), metrics
        )


def _sample(s: Stratum) -> Sample:
    worlds = len(s.seeds)
    counts = resample(worlds, s.rng("bootstrap"))
    return Sample(s.value.reshape(worlds, -1), s.agents.reshape(worlds, -1), counts)


def _records(body: _Body, metrics: Mapping[str, Metric]) -> Iterator[Record]:
    s, middle = body.stratum, body.scenario == ALL_INTERQUARTILE
    defined = (~np.isnan(body.value)).sum(axis=0)
    for n, navigator in enumerate(s.navigators):
        episodes = int(body.attempted[:, n].sum())
        if not episodes:
            continue
        decisions, seconds = _mean_cost(body, n)
        for m, name in enumerate(s.metrics):
            at, place, metric = n * len(s.metrics) + m, body.places[m][n], metrics.get(name)
            yield Record(
                navigator=navigator,
                scenario=body.scenario,
                track=s.track,
                perception=s.perception,
                role=s.role,
                metric=name,
                value=float(body.found.value[at]),
                low=float(body.found.low[at]),
                high=float(body.found.high[at]),
                unit=metric.unit if metric else "",
                better=metric.better if metric else None,
                episodes=episodes,
                defined=int(defined[n, m]),
                failures=int(body.failed[:, n].sum()),
                rank_low=place.low,
                rank_high=place.high,
                ranked=place.ranked,
                note=place.note,
                split=s.split,
                scenario_hash=s.scenario_hash if body.single else "",
                horizon=s.horizon if body.single else float("nan"),
                dt=s.dt if body.single else float("nan"),
                rehearsal=s.rehearsal,
                rehearsal_decisions=decisions,
                rehearsal_seconds=seconds,
                **_spread(spread_of(body.scenarios, navigator, name, middle)),
            )


def _spread(found: Spread) -> dict[str, Any]:
    """Return the fields of a record about the trainings of its navigator."""
    return {
        "trainings": found.count, "training_least": found.least, "training_most": found.most,
        "training_deviation": found.deviation,
    }  # fmt: skip


def _mean_cost(body: _Body, navigator: int) -> tuple[float, float]:
    """Return decisions and seconds of rehearsals, mean over attempted worlds; NaN without any."""
    if not body.stratum.rehearsal:
        return float("nan"), float("nan")
    decisions, seconds = body.cost[body.attempted[:, navigator], navigator].mean(axis=0)
    return float(decisions), float(seconds)


def _missing(
    group: list[Stratum], cells: Iterable[NotApplicable], metrics: Mapping[str, Metric]
) -> Iterator[Record]:
    """Yield records of cells that cannot be run, in every stratum that they would be part of."""
    for cell in cells:
        for s in group:
            place = cell.scenario, cell.track, cell.perception
            if place != (s.scenario, s.track, s.perception):
                continue
            if (
                cell.navigator in s.navigators
                and s.attempted[:, s.navigators.index(cell.navigator)].any()
            ):
                continue  # another run has results of it
            for name in s.metrics:
                metric = metrics.get(name)
                yield Record(
                    navigator=cell.navigator,
                    scenario=s.scenario,
                    track=s.track,
                    perception=s.perception,
                    role=s.role,
                    metric=name,
                    value=float("nan"),
                    low=float("nan"),
                    high=float("nan"),
                    unit=metric.unit if metric else "",
                    better=metric.better if metric else None,
                    episodes=0,
                    defined=0,
                    failures=0,
                    rank_low=None,
                    rank_high=None,
                    ranked=0,
                    note=f"n/a ({cell.reason})",
                    split=s.split,
                    scenario_hash=s.scenario_hash,
                    horizon=s.horizon,
                    dt=s.dt,
                    rehearsal=s.rehearsal,
                )


def _place(names: Sequence[str]) -> Callable[[Record], tuple[Any, ...]]:
    """Return the sort key of records: scenarios, then aggregates; navigators and metrics within."""
    order = {name: place for place, name in enumerate(names)}
    aggregates = {ALL: 1, ALL_INTERQUARTILE: 2}

    def key(r: Record) -> tuple[Any, ...]:
        last = aggregates.get(r.scenario, 0)
        variant = () if last else (r.scenario, r.scenario_hash, r.horizon, r.dt)
        return (
            r.split,
            0 if r.price is None else 1 + PRICES.index(r.price),
            r.track,
            r.perception,
            last,
            variant,
            r.role,
            r.rehearsal,
            r.navigator,
            order[r.metric],
        )

    return key
