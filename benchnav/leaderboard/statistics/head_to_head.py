"""Head-to-head comparison of two navigators, on all metrics and places where both were run."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import TYPE_CHECKING

import numpy as np

from benchnav.arrays import IntArray
from benchnav.errors import UsageError, did_you_mean
from benchnav.leaderboard.record import ALL, NotApplicable
from benchnav.leaderboard.statistics.comparison import Comparison, as_family
from benchnav.leaderboard.statistics.difference import Moments, difference
from benchnav.leaderboard.statistics.estimate import columns_of
from benchnav.leaderboard.statistics.not_comparable import absences
from benchnav.leaderboard.statistics.over_trainings import with_trainings
from benchnav.leaderboard.statistics.paired import differences, side_by_side
from benchnav.leaderboard.statistics.strata import Stratum, strata
from benchnav.metrics.metric import Metric
from benchnav.navigation.plugin.trainings import entry_of, labels_of_entry

if TYPE_CHECKING:
    import pyarrow as pa


@dataclass(frozen=True)
class Duel:
    """The result of `benchnav compare`: one family of comparisons, and notes on missing ones."""

    first: str
    second: str
    comparisons: tuple[Comparison, ...]  # by metric, split, condition, role, scenario
    notes: tuple[str, ...]


def duel(
    results: pa.Table,
    metrics: Mapping[str, Metric],
    names: Sequence[str],
    first: str,
    second: str,
    gaps: Sequence[NotApplicable] = (),
    trained: Collection[str] = (),
) -> Duel:
    """Compare ``first`` − ``second`` by the metrics ``names``, wherever both were run.

    Each scenario, track, perception and role is compared on its own. If both were run in several
    scenarios under one condition, also compare over all of these with equal weights. All
    comparisons form one family. ``gaps`` are cells that could not be run, ``trained`` the
    navigators that learned. Each name is that of an entry, or the label of one of its trainings.
    Raises UsageError if one of the two is not in ``results``, or they share no world.
    """
    labels = _labels(results, first, second)
    import pyarrow.compute as pc

    chosen = pc.and_(
        pc.is_in(results["navigator"], value_set=_strings(*labels)),
        pc.is_in(results["metric"], value_set=_strings(*names)),
    )
    found = strata(results.filter(chosen), metrics, mixed=True, apart=(first, second))
    met = [s for s in found if len(s.navigators) == 2 and s.attempted.all(axis=1).any()]
    notes = absences(found, first, second, gaps)
    if not met:
        raise UsageError(
            f"Two navigators can be compared if both were run in the same worlds. {first!r}"
            f" and {second!r} never were.{''.join(f' {note}' for note in notes)}"
        )
    chosen = [metrics[name] for name in names]
    every = [c for s in met for c in _in_one(s, first, second, chosen)]
    for _, group in groupby(met, key=lambda s: (s.split, s.track, s.perception, s.role)):
        every += _over_all(list(group), first, second, chosen)
    order = {name: place for place, name in enumerate(names)}
    every.sort(key=lambda c: (order[c.metric], c.split, c.track, c.perception, c.role))  # stable
    every = list(with_trainings(every, met, metrics, trained))
    return Duel(first, second, as_family(every, metrics), tuple(notes))


def _labels(results: pa.Table, first: str, second: str) -> tuple[str, ...]:
    """Return the labels of both entries. Raises UsageError for an unknown or a repeated one."""
    labels = results["navigator"].unique().to_pylist()
    known = sorted({*labels, *map(entry_of, labels)})
    for name in (first, second):
        if name not in known:
            raise UsageError(
                f"A navigator to compare must be in the run. Got {name!r} instead."
                f"{did_you_mean(name, known)}"
            )
    if first == second:
        raise UsageError(f"Two different navigators can be compared. Got {first!r} twice.")
    if first in (second, entry_of(second)) or second == entry_of(first):
        raise UsageError(
            "A training can be compared with another training or with another entry. Got"
            f" {first!r} and {second!r}, one of which includes the other."
        )
    return (*labels_of_entry(first, labels), *labels_of_entry(second, labels))


def _strings(*values: str) -> pa.Array:
    import pyarrow as pa

    return pa.array(values, pa.string())


def _sides(s: Stratum, first: str, second: str, count: int) -> tuple[IntArray, IntArray]:
    """Return the places (C,), (C,) of both navigators in a stratum."""
    one, other = s.navigators.index(first), s.navigators.index(second)
    return np.full(count, one, np.int64), np.full(count, other, np.int64)


def _in_one(s: Stratum, first: str, second: str, metrics: Sequence[Metric]) -> list[Comparison]:
    """Compare in one scenario, by the metrics measured there."""
    held = [metric for metric in metrics if metric.name in s.metrics]
    return differences(s, *_sides(s, first, second, len(held)), held)


def _over_all(
    group: list[Stratum], first: str, second: str, metrics: Sequence[Metric]
) -> Iterator[Comparison]:
    """Compare over the scenarios of one split, condition and role, if there are several."""
    if len(group) < 2:
        return
    sides = [side_by_side(s, *_sides(s, first, second, len(metrics)), metrics) for s in group]
    found = difference([Moments.of(side) for side in sides], columns_of(metrics))
    s = group[0]
    granted = [int(s.granted[s.navigators.index(name)]) for name in (first, second)]
    for m, metric in enumerate(metrics):
        yield Comparison(
            first=first,
            second=second,
            scenario=ALL,
            track=s.track,
            perception=s.perception,
            role=s.role,
            metric=metric.name,
            worlds=int(found.worlds[m]),
            difference=float(found.value[m]),
            low=float(found.low[m]),
            high=float(found.high[m]),
            p=float(found.p[m]),
            split=s.split,
            scenario_hash="",
            horizon=math.nan,
            dt=math.nan,
            first_rehearsal=granted[0],
            second_rehearsal=granted[1],
        )
