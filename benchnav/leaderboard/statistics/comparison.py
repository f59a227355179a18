"""One paired comparison, with the data needed to judge it."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from benchnav.leaderboard.record import OPTIONAL
from benchnav.leaderboard.statistics.difference import least_p
from benchnav.leaderboard.statistics.interval import ALPHA
from benchnav.leaderboard.statistics.significance import holm
from benchnav.metrics.metric import Metric

Verdict = Literal[
    "better", "worse", "higher", "lower", "tie", "too few worlds", "no common world",
    "not as equals",
]  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class Comparison:
    """The difference of two navigators' values in the worlds of both."""

    first: str
    second: str
    scenario: str  # or `benchnav.leaderboard.record.ALL`
    track: str
    perception: str = "exact"
    role: str
    metric: str
    worlds: int  # worlds that both attempted and in which both have a value
    difference: float  # mean of first − second, in the metric's unit; NaN without such worlds
    low: float  # of its 95 % interval; NaN if the worlds give none
    high: float
    p: float  # of the hypothesis of no difference; < 0.05 exactly if the interval excludes 0
    split: str
    scenario_hash: str  # "" over all scenarios; the next two are then NaN
    horizon: float  # [s]
    dt: float  # [s]
    first_rehearsal: int = 0  # rehearsals of each world granted to the first
    second_rehearsal: int = 0
    adjusted: float = math.nan  # p after Holm's correction, over the family
    family: int = 0  # number of comparisons in the family
    verdict: Verdict = "tie"  # about the first
    first_trainings: int = field(default=1, metadata=OPTIONAL)
    first_deviation: float = field(default=math.nan, metadata=OPTIONAL)  # standard, of trainings
    second_trainings: int = field(default=1, metadata=OPTIONAL)
    second_deviation: float = field(default=math.nan, metadata=OPTIONAL)
    training_low: float = field(default=math.nan, metadata=OPTIONAL)  # 95 %, over worlds
    training_high: float = field(default=math.nan, metadata=OPTIONAL)  # and trainings


def as_family(found: Sequence[Comparison], metrics: Mapping[str, Metric]) -> tuple[Comparison, ...]:
    """Return the comparisons as one family: p adjusted by Holm's procedure over all of them.

    Comparisons without a common world test nothing and do not count in the family.
    """
    tested = np.array([c.worlds > 0 for c in found], dtype=np.bool_)
    p = np.array([c.p for c in found])
    p[tested] = holm(p[tested])
    family = int(tested.sum())
    judged = (
        replace(c, adjusted=float(adjusted), family=family)
        for c, adjusted in zip(found, p, strict=True)
    )
    return tuple(replace(c, verdict=_verdict(c, metrics.get(c.metric))) for c in judged)


def least_worlds(family: int) -> int:
    """Return the fewest worlds in which one of ``family`` comparisons can show a difference."""
    worlds = 2
    while family * least_p(worlds) >= ALPHA:
        worlds += 1
    return worlds


def _verdict(c: Comparison, metric: Metric | None) -> Verdict:
    """Return the verdict; "too few worlds" if even the largest differences would be a tie."""
    if not c.worlds:
        return "no common world"
    if c.first_rehearsal != c.second_rehearsal:
        return "not as equals"
    if not c.adjusted < ALPHA:
        return "too few worlds" if c.family * least_p(c.worlds) >= ALPHA else "tie"
    if metric is None or metric.better is None:
        return "higher" if c.difference > 0 else "lower"
    return "better" if (c.difference > 0) == (metric.better == "higher") else "worse"
