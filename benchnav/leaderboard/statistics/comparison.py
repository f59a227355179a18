"""One paired comparison, with everything that is needed to judge it."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from benchnav.leaderboard.statistics.difference import least_p
from benchnav.leaderboard.statistics.interval import ALPHA
from benchnav.leaderboard.statistics.significance import holm
from benchnav.metrics.metric import Metric

Verdict = Literal[
    "better", "worse", "higher", "lower", "tie", "too few worlds", "no common world",
    "not as equals",
]  # fmt: skip


@dataclass(frozen=True)
class Comparison:
    """How much the first navigator's values exceed the second's in the worlds of both."""

    first: str
    second: str
    scenario: str  # or `benchnav.leaderboard.record.ALL`
    track: str
    role: str
    metric: str
    worlds: int  # that both attempted and in which both have a value
    difference: float  # mean of first − second, in the metric's unit; NaN without such worlds
    low: float  # of its 95 % interval; NaN where the worlds give none
    high: float
    p: float  # of no difference; below 0.05 exactly where the interval excludes 0
    split: str
    scenario_hash: str  # "" over all scenarios, as the next two are NaN
    horizon: float  # [s]
    dt: float  # [s]
    first_rehearsal: int = 0  # rehearsals of each world that the first was granted
    second_rehearsal: int = 0
    adjusted: float = math.nan  # p after Holm, over the family
    family: int = 0  # how many comparisons are judged together
    verdict: Verdict = "tie"  # on the first


def as_family(found: Sequence[Comparison], metrics: Mapping[str, Metric]) -> tuple[Comparison, ...]:
    """The same comparisons, judged together: p adjusted by Holm's procedure over all of them.

    Those without a common world test nothing and are none of the family.
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


def _verdict(c: Comparison, metric: Metric | None) -> Verdict:
    """Too few worlds: had each of them differed by the whole range, it would be a tie too."""
    if not c.worlds:
        return "no common world"
    if c.first_rehearsal != c.second_rehearsal:
        return "not as equals"
    if not c.adjusted < ALPHA:
        return "too few worlds" if c.family * least_p(c.worlds) >= ALPHA else "tie"
    if metric is None or metric.better is None or metric.conditional:
        return "higher" if c.difference > 0 else "lower"
    return "better" if (c.difference > 0) == (metric.better == "higher") else "worse"
