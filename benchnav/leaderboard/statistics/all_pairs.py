"""Head-to-head comparisons of every two navigators, computed together.

Each has the numbers of `benchnav.leaderboard.statistics.head_to_head.duel`.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations, groupby
from typing import TYPE_CHECKING

import numpy as np

from benchnav.leaderboard.record import ALL, NotApplicable
from benchnav.leaderboard.statistics.comparison import Comparison, as_family
from benchnav.leaderboard.statistics.difference import Moments, difference
from benchnav.leaderboard.statistics.estimate import columns_of
from benchnav.leaderboard.statistics.head_to_head import Duel, duel
from benchnav.leaderboard.statistics.not_comparable import absences
from benchnav.leaderboard.statistics.over_trainings import with_trainings
from benchnav.leaderboard.statistics.paired import differences, side_by_side
from benchnav.leaderboard.statistics.significance import pairs
from benchnav.leaderboard.statistics.strata import Stratum, align, strata
from benchnav.metrics.metric import Metric
from benchnav.navigation.plugin.trainings import entries_of

if TYPE_CHECKING:
    import pyarrow as pa

Pair = tuple[str, str]


@dataclass
class _Found:
    """The comparisons of one pair, and the number of its scenarios by `_place`."""

    comparisons: list[Comparison] = field(default_factory=list)
    scenarios: dict[tuple[str, str, str, str], int] = field(default_factory=dict)


def duels(
    results: pa.Table,
    metrics: Mapping[str, Metric],
    names: Sequence[str],
    gaps: Sequence[NotApplicable] = (),
    trained: Collection[str] = (),
) -> Iterator[Duel]:
    """Yield the comparison of every two entries by the metrics ``names``, in sorted order.

    Two that share no world have no comparisons. The arguments are those of `duel`.
    """
    import pyarrow as pa
    import pyarrow.compute as pc

    rows = results.filter(pc.is_in(results["metric"], value_set=pa.array(names, pa.string())))
    navigators = sorted(entries_of(rows["navigator"].unique().to_pylist()))
    every = strata(rows, metrics, mixed=True)
    found = _all_comparisons(every, [metrics[name] for name in names])
    uniform = _holds_every_metric(rows, names)
    order = {name: place for place, name in enumerate(names)}
    for pair in combinations(navigators, 2):
        if pair in found and (not uniform or _failed_together(every, pair)):
            yield duel(rows, metrics, names, *pair, gaps, trained)
            continue
        comparisons = found[pair].comparisons if pair in found else []
        comparisons.sort(key=lambda c: (order[c.metric], *_place(c)))  # stable
        notes = absences(_strata_of(every, pair), *pair, gaps)
        comparisons = list(with_trainings(comparisons, every, metrics, trained))
        yield Duel(*pair, as_family(comparisons, metrics), tuple(notes))


def notes_by_condition(
    results: pa.Table,
    metrics: Mapping[str, Metric],
    conditions: Sequence[tuple[str, str]],
    gaps: Sequence[NotApplicable] = (),
) -> dict[Pair, list[list[str]]]:
    """Return for every two navigators the notes of `Duel` on each (track, perception) alone."""
    every = strata(results, metrics, mixed=True)
    navigators = sorted(entries_of(results["navigator"].unique().to_pylist()))
    found: dict[Pair, list[list[str]]] = {}
    for pair in combinations(navigators, 2):
        shared = _strata_of(every, pair)
        found[pair] = [
            absences([s for s in shared if (s.track, s.perception) == wanted], *pair, gaps)
            for wanted in conditions
        ]
    return found


def _all_comparisons(every: Sequence[Stratum], metrics: Sequence[Metric]) -> dict[Pair, _Found]:
    found: dict[Pair, _Found] = {}
    for s in every:
        for c in _in_one(s, metrics):
            pair = found.setdefault((c.first, c.second), _Found())
            pair.comparisons.append(c)
            if c.metric == metrics[0].name:
                place = _place(s)
                pair.scenarios[place] = pair.scenarios.get(place, 0) + 1
    for place, group in groupby(every, key=_place):
        for c in _over_all(align(list(group)), metrics):
            held = found.get((c.first, c.second))
            if held is not None and held.scenarios.get(place, 0) > 1:
                held.comparisons.append(c)
    return found


def _place(of: Stratum | Comparison) -> tuple[str, str, str, str]:
    """Return what the scenarios of a mean share: split, track, perception and role."""
    return of.split, of.track, of.perception, of.role


def _in_one(s: Stratum, metrics: Sequence[Metric]) -> Iterator[Comparison]:
    """Yield the comparisons in one scenario of the pairs that share a world there."""
    held = [metric for metric in metrics if metric.name in s.metrics]
    first, second = pairs(len(s.navigators))
    met = (s.attempted[:, first] & s.attempted[:, second]).any(axis=0)
    if not held or not met.any():
        return
    first, second = (np.repeat(side[met], len(held)) for side in (first, second))
    yield from differences(s, first, second, held * int(met.sum()))


def _over_all(group: Sequence[Stratum], metrics: Sequence[Metric]) -> Iterator[Comparison]:
    """Yield the comparisons of all pairs over the scenarios of one split, condition and role."""
    s = group[0]
    if len(s.navigators) < 2:
        return
    first, second = (np.repeat(side, len(metrics)) for side in pairs(len(s.navigators)))
    columns = [*metrics] * (len(first) // len(metrics))
    sides = [side_by_side(each, first, second, columns) for each in group]
    found = difference([Moments.of(side) for side in sides], columns_of(columns))
    granted = np.max([each.granted for each in group], axis=0)
    for k, (i, j) in enumerate(zip(first.tolist(), second.tolist(), strict=True)):
        yield Comparison(
            first=s.navigators[i],
            second=s.navigators[j],
            scenario=ALL,
            track=s.track,
            perception=s.perception,
            role=s.role,
            metric=columns[k].name,
            worlds=int(found.worlds[k]),
            difference=float(found.value[k]),
            low=float(found.low[k]),
            high=float(found.high[k]),
            p=float(found.p[k]),
            split=s.split,
            scenario_hash="",
            horizon=math.nan,
            dt=math.nan,
            first_rehearsal=int(granted[i]),
            second_rehearsal=int(granted[j]),
        )


def _holds_every_metric(rows: pa.Table, names: Sequence[str]) -> bool:
    """Whether each navigator has equally many values of each metric."""
    keys = ["navigator", "metric"]
    counts = rows.select(keys).group_by(keys).aggregate([([], "count_all")]).to_pylist()
    by_navigator: dict[str, list[int]] = {}
    for row in counts:
        by_navigator.setdefault(row["navigator"], []).append(row["count_all"])
    return all(len(n) == len(names) and len(set(n)) == 1 for n in by_navigator.values())


def _failed_together(every: Sequence[Stratum], pair: Pair) -> bool:
    """Whether both failed in one world: its values then depend on other navigators."""
    for s in every:
        if set(pair) <= set(s.navigators):
            one, other = (s.navigators.index(name) for name in pair)
            if (s.failed[:, one] & s.failed[:, other]).any():
                return True
    return False


def _strata_of(every: Sequence[Stratum], pair: Pair) -> list[Stratum]:
    """Return the strata of only two navigators; without their values."""
    found = []
    for s in every:
        at = [s.navigators.index(name) for name in pair if name in s.navigators]
        at = [n for n in at if s.attempted[:, n].any()]
        if at:
            found.append(
                replace(
                    s,
                    navigators=tuple(s.navigators[n] for n in at),
                    attempted=s.attempted[:, at],
                    failed=s.failed[:, at],
                    granted=s.granted[at],
                )
            )
    return found
