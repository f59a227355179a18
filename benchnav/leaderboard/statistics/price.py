"""Prices: the loss of each navigator in the same worlds without a map, or by noise."""

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import groupby

import numpy as np

from benchnav.arrays import FloatArray, IntArray
from benchnav.leaderboard.record import (
    ALL,
    IGNORANCE,
    NO_MAP,
    PRICES,
    NotApplicable,
    Price,
    Record,
)
from benchnav.leaderboard.statistics.difference import Difference, Moments, difference
from benchnav.leaderboard.statistics.estimate import columns_of
from benchnav.leaderboard.statistics.strata import Stratum, align
from benchnav.metrics.metric import Metric


def prices(
    found: Iterable[Stratum],
    metrics: Mapping[str, Metric],
    mapless: Collection[str],
    gaps: Sequence[NotApplicable],
) -> Iterator[Record]:
    """Yield the paired differences of each of `PRICES`, per scenario and over all.

    ``mapless`` navigators use no map: their price of ignorance is 0, with the note `NO_MAP`. If
    ``gaps`` contain a navigator on one of the two sides, its note is the reason.
    """
    every = list(found)
    for price in PRICES:
        idle = mapless if price is IGNORANCE else ()
        yield from _prices(price, every, metrics, idle, gaps)


def _prices(
    price: Price,
    found: Sequence[Stratum],
    metrics: Mapping[str, Metric],
    mapless: Collection[str],
    gaps: Sequence[NotApplicable],
) -> Iterator[Record]:
    sides = price.first, price.second

    def contest(s: Stratum) -> tuple[str, str, int, str]:
        return s.split, s.role, s.rehearsal, price.other(s)

    ordered = sorted((s for s in found if getattr(s, price.axis) in sides), key=contest)
    for key, group in groupby(ordered, key=contest):
        priced = [_Priced(price, *pair) for pair in _pairs(price, align(list(group)))]
        if not priced:
            continue
        reasons = {
            (gap.navigator, gap.scenario): gap.reason
            for gap in gaps
            if getattr(gap, price.axis) in sides and price.other(gap) == key[-1]
        }
        s = priced[0].one
        column = columns_of([metrics.get(name) for name in s.metrics] * len(s.navigators))
        parts = [Moments.of(each.differences) for each in priced]
        for each, part in zip(priced, parts, strict=True):
            own = difference([part], column)
            yield from _records(each.one, [each], own, metrics, _notes([each], mapless, reasons))
        if len(priced) > 1:
            whole = difference(parts, column)
            yield from _records(None, priced, whole, metrics, _notes(priced, mapless, reasons))


@dataclass(frozen=True, eq=False)
class _Priced:
    """One scenario on both sides of a price, on the same axes."""

    price: Price
    one: Stratum  # known, exact
    other: Stratum  # unknown, noisy

    @property
    def places(self) -> tuple[IntArray, IntArray]:
        """The indices (n,), (n,) of the common seeds in both strata."""
        _, one, other = np.intersect1d(self.one.seeds, self.other.seeds, return_indices=True)
        return one, other

    @cached_property
    def differences(self) -> FloatArray:
        """The differences one − other (n, N·M), navigator by navigator."""
        one, other = self.places
        apart: FloatArray = self.one.value[one] - self.other.value[other]
        return apart.reshape(len(one), -1)

    @property
    def episodes(self) -> IntArray:
        """The number (N,) of worlds attempted on both sides."""
        one, other = self.places
        count: IntArray = (self.one.attempted[one] & self.other.attempted[other]).sum(axis=0)
        return count

    @property
    def failures(self) -> IntArray:
        """The number (N,) of failures of the navigators, on both sides together."""
        count: IntArray = self.one.failed.sum(axis=0) + self.other.failed.sum(axis=0)
        return count


def _pairs(price: Price, found: list[Stratum]) -> Iterator[tuple[Stratum, Stratum]]:
    """Yield both sides of each scenario that was run on both with common seeds."""
    at = {(s.scenario, s.scenario_hash, s.horizon, s.dt, getattr(s, price.axis)): s for s in found}
    for key, one in sorted(at.items()):
        other = at.get((*key[:-1], price.second))
        if key[-1] == price.first and other and np.intersect1d(one.seeds, other.seeds).size:
            yield one, other


def _notes(
    priced: list[_Priced], mapless: Collection[str], reasons: Mapping[tuple[str, str], str]
) -> list[str]:
    """Return, per navigator, the reason for a price that is missing in some scenario; else ""."""
    held = np.sum([each.episodes > 0 for each in priced], axis=0)
    notes = []
    for name, count in zip(priced[0].one.navigators, held.tolist(), strict=True):
        reason = reasons.get((name, priced[0].one.scenario))
        note = f"n/a ({reason})" if reason else f"not run in both {priced[0].price.axis}s"
        if count:
            note = "" if count == len(priced) else f"in {count} of {len(priced)} scenarios"
        notes.append(NO_MAP if name in mapless else note)
    return notes


def _records(
    of: Stratum | None,
    priced: list[_Priced],
    found: Difference,
    metrics: Mapping[str, Metric],
    notes: list[str],
) -> Iterator[Record]:
    """Yield the records of one scenario, or of all (None)."""
    s, price = priced[0].one, priced[0].price
    track, perception = price.place_of(s)
    episodes = np.sum([each.episodes for each in priced], axis=0)
    failures = np.sum([each.failures for each in priced], axis=0)
    nan = float("nan")
    for n, navigator in enumerate(s.navigators):
        none = notes[n] == NO_MAP
        for m, name in enumerate(s.metrics):
            at, metric = n * len(s.metrics) + m, metrics.get(name)
            low, high = (nan, nan) if none else (float(found.low[at]), float(found.high[at]))
            yield Record(
                navigator=navigator,
                scenario=of.scenario if of else ALL,
                track=track,
                perception=perception,
                role=s.role,
                metric=name,
                value=0.0 if none else float(found.value[at]),
                low=low,
                high=high,
                unit=metric.unit if metric else "",
                better=metric.better if metric else None,
                episodes=int(episodes[n]),
                defined=int(found.worlds[at]),
                failures=int(failures[n]),
                rank_low=None,
                rank_high=None,
                ranked=0,
                note=notes[n],
                split=s.split,
                scenario_hash=of.scenario_hash if of else "",
                horizon=of.horizon if of else nan,
                dt=of.dt if of else nan,
                rehearsal=s.rehearsal,
            )
