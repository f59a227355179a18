"""Differences over trainings: what other random seeds of the training may change.

The interval of a comparison is over worlds, for these trainings. An entry with several trainings
also shows their variance, so the interval can be extended to other trainings of the same recipe:
the half-widths over worlds and over trainings are combined as independent deviations (G. Y. Zou,
W. Huang and X. Zhang, Computational Statistics & Data Analysis 53, 2009). The means of trainings
share their worlds, so the part of their variance that is due to the choice of worlds counts twice:
the interval is never too narrow for this reason.
"""

import math
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from benchnav.arrays import BoolArray
from benchnav.leaderboard.record import ALL
from benchnav.leaderboard.statistics.comparison import Comparison
from benchnav.leaderboard.statistics.interval import students
from benchnav.leaderboard.statistics.strata import Stratum
from benchnav.leaderboard.statistics.trainings import Spread, spread_of
from benchnav.metrics.metric import Metric


def with_trainings(
    comparisons: Iterable[Comparison],
    found: Sequence[Stratum],
    metrics: Mapping[str, Metric],
    trained: Collection[str],
) -> Iterator[Comparison]:
    """Yield the comparisons, those of entries with several trainings with their second interval.

    ``found`` are the strata of the comparisons; ``trained`` are the navigators that learned. If one
    of the two was trained once, its trainings are assumed to vary as those of the other.
    """
    for c in comparisons:
        pair = c.first, c.second
        group = [s for s in found if any(name in s.trainings for name in pair) and _holds(s, c)]
        spreads = [spread_of([_common(s, pair) for s in group], name, c.metric) for name in pair]
        if all(spread.count < 2 for spread in spreads):
            yield c
            continue
        learned = [name in trained or s.count > 1 for name, s in zip(pair, spreads, strict=True)]
        apart = half_width(spreads, learned)
        metric = metrics[c.metric]
        most = metric.high - metric.low
        yield replace(
            c,
            first_trainings=spreads[0].count,
            first_deviation=spreads[0].deviation,
            second_trainings=spreads[1].count,
            second_deviation=spreads[1].deviation,
            training_low=max(c.difference - math.hypot(c.difference - c.low, apart), -most),
            training_high=min(c.difference + math.hypot(c.high - c.difference, apart), most),
        )


def half_width(spreads: Sequence[Spread], learned: Sequence[bool]) -> float:
    """Return the half-width of the 95 % interval of a difference over trainings; NaN if unknown.

    The degrees of freedom are those of F. E. Satterthwaite, Biometrics Bulletin 2 (1946).
    """
    several = [spread for spread in spreads if spread.count > 1]
    known = [spread for spread in several if not math.isnan(spread.deviation)]
    if len(known) < len(several):
        return math.nan
    if len(known) == 1:
        (own,) = known
        share = 1.0 / own.count + (1.0 if all(learned) else 0.0)
        parts = [(own.deviation**2 * share, own.count - 1.0)]
    else:
        parts = [(each.deviation**2 / each.count, each.count - 1.0) for each in known]
    variance = sum(part for part, _ in parts)
    if variance == 0.0:
        return 0.0
    freedom = variance**2 / sum(part**2 / free for part, free in parts)
    return float(students(np.array([freedom]))[0]) * math.sqrt(variance)


def _holds(s: Stratum, c: Comparison) -> bool:
    """Whether a comparison is about a stratum, alone or together with others."""
    place = s.split, s.track, s.perception, s.role
    if place != (c.split, c.track, c.perception, c.role):
        return False
    if not {c.first, c.second} <= {*s.navigators} or not _both(s, (c.first, c.second)).any():
        return False
    own = s.scenario, s.scenario_hash, s.horizon, s.dt
    return c.scenario == ALL or own == (c.scenario, c.scenario_hash, c.horizon, c.dt)


def _common(s: Stratum, pair: tuple[str, str]) -> Stratum:
    """Return the values of trainings in the worlds that both attempted."""
    both = _both(s, pair)
    return replace(s, trainings={name: values[both] for name, values in s.trainings.items()})


def _both(s: Stratum, pair: tuple[str, str]) -> BoolArray:
    """Return the worlds (S,) that both attempted."""
    first, second = (s.attempted[:, s.navigators.index(name)] for name in pair)
    both: BoolArray = first & second
    return both
