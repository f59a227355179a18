"""The price of ignorance: the gain of each navigator by the map, in the same worlds."""

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import groupby

import numpy as np

from benchnav.arrays import FloatArray, IntArray
from benchnav.leaderboard.record import ALL, NO_MAP, PRICE, NotApplicable, Record
from benchnav.leaderboard.statistics.difference import Difference, Moments, difference
from benchnav.leaderboard.statistics.estimate import columns_of
from benchnav.leaderboard.statistics.strata import Stratum, align
from benchnav.metrics.metric import Metric

TRACKS = ("known", "unknown")


def prices(
    found: Iterable[Stratum],
    metrics: Mapping[str, Metric],
    mapless: Collection[str],
    gaps: Sequence[NotApplicable],
) -> Iterator[Record]:
    """Yield paired differences known − unknown, per scenario and over all: records of `PRICE`.

    ``mapless`` navigators use no map: their difference is 0, with the note `NO_MAP`. If ``gaps``
    contain a navigator in one of the two tracks, its note is the reason.
    """
    reasons = {(gap.navigator, gap.scenario): gap.reason for gap in gaps if gap.track in TRACKS}
    ordered = sorted((s for s in found if s.track in TRACKS), key=_contest)
    for _, contest in groupby(ordered, key=_contest):
        priced = [_Priced(*pair) for pair in _pairs(align(list(contest)))]
        if not priced:
            continue
        s = priced[0].known
        column = columns_of([metrics.get(name) for name in s.metrics] * len(s.navigators))
        parts = [Moments.of(each.differences) for each in priced]
        for each, part in zip(priced, parts, strict=True):
            own = difference([part], column)
            yield from _records(each.known, [each], own, metrics, _notes([each], mapless, reasons))
        if len(priced) > 1:
            whole = difference(parts, column)
            yield from _records(None, priced, whole, metrics, _notes(priced, mapless, reasons))


@dataclass(frozen=True, eq=False)
class _Priced:
    """One scenario in both tracks, on the same axes."""

    known: Stratum
    unknown: Stratum

    @property
    def places(self) -> tuple[IntArray, IntArray]:
        """The indices (n,), (n,) of the common seeds in both strata."""
        _, one, other = np.intersect1d(self.known.seeds, self.unknown.seeds, return_indices=True)
        return one, other

    @cached_property
    def differences(self) -> FloatArray:
        """The differences known − unknown (n, N·M), navigator by navigator."""
        one, other = self.places
        apart: FloatArray = self.known.value[one] - self.unknown.value[other]
        return apart.reshape(len(one), -1)

    @property
    def episodes(self) -> IntArray:
        """The number (N,) of worlds attempted in both tracks."""
        one, other = self.places
        count: IntArray = (self.known.attempted[one] & self.unknown.attempted[other]).sum(axis=0)
        return count

    @property
    def failures(self) -> IntArray:
        """The number (N,) of failures of the navigators, in both tracks together."""
        count: IntArray = self.known.failed.sum(axis=0) + self.unknown.failed.sum(axis=0)
        return count


def _contest(s: Stratum) -> tuple[str, str, int]:
    return s.split, s.role, s.rehearsal


def _pairs(found: list[Stratum]) -> Iterator[tuple[Stratum, Stratum]]:
    """Yield (known, unknown) of each scenario that was run in both tracks with common seeds."""
    at = {(s.scenario, s.scenario_hash, s.horizon, s.dt, s.track): s for s in found}
    for key, known in sorted(at.items()):
        unknown = at.get((*key[:-1], TRACKS[1]))
        if key[-1] == TRACKS[0] and unknown and np.intersect1d(known.seeds, unknown.seeds).size:
            yield known, unknown


def _notes(
    priced: list[_Priced], mapless: Collection[str], reasons: Mapping[tuple[str, str], str]
) -> list[str]:
    """Return, per navigator, the reason for a price that is missing in some scenario; else ""."""
    held = np.sum([each.episodes > 0 for each in priced], axis=0)
    notes = []
    for name, count in zip(priced[0].known.navigators, held.tolist(), strict=True):
        reason = reasons.get((name, priced[0].known.scenario))
        note = f"n/a ({reason})" if reason else "not run in both tracks"
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
    s = priced[0].known
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
                track=PRICE,
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
