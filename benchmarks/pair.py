"""A benchmark: what is measured, what it is compared with in the same run, and the result.

Both sides of a pair are timed in turns, A B B A, so that a machine that gets slower or faster
meanwhile changes their ratio little. Where there is no peer, the other side is a yardstick: fixed
work that uses nothing of benchnav, by which runs on different days and machines compare.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.stats import bootstrap

from benchmarks.yardstick import yardstick

Rate = Callable[[], float]
"""Does the work once; returns how much of it is done a second."""


class NotMeasuredError(Exception):
    """One side cannot be measured; the text is the reason."""


@dataclass(frozen=True, kw_only=True)
class Pair:
    """A benchmark and its other side.

    ``wanted`` is the ratio of the rates to reach. Where the other side is the yardstick, it is the
    rate itself, or the time [s] where the unit is s.
    """

    name: str
    ours: Rate
    wanted: float
    unit: str
    peer: str = ""  # its name; "" for the yardstick
    theirs: Rate = yardstick
    blocks: int = 4  # of A B B A
    warm: bool = True  # whether each side is done once before, to load and compile
    limit: str = ""  # a sentence: what limits it, where the wanted ratio is not reached


@dataclass(frozen=True, kw_only=True)
class Row:
    """A measured pair; ``note`` is the reason if it could not be measured."""

    pair: Pair
    value: float = math.nan  # the best rate, or time [s]
    ratio: float = math.nan  # of the rates, the geometric mean
    low: float = math.nan  # the ends of its 95 % interval
    high: float = math.nan
    note: str = ""

    @property
    def text(self) -> str:
        """The ratio and its interval."""
        return f"{number(self.ratio)} [{number(self.low)}, {number(self.high)}]"

    @property
    def reached(self) -> bool:
        """Whether the wanted ratio, rate or time is reached."""
        if self.pair.peer:
            return self.ratio >= self.pair.wanted
        if self.pair.unit == "s":
            return self.value <= self.pair.wanted
        return self.value >= self.pair.wanted


def measured(pair: Pair) -> Row:
    """Measure both sides in turns."""
    ours, theirs = [], []
    try:
        if pair.warm:
            pair.ours(), pair.theirs()
        for _ in range(pair.blocks):
            ours.append(pair.ours())
            theirs += [pair.theirs(), pair.theirs()]
            ours.append(pair.ours())
    except NotMeasuredError as error:
        return Row(pair=pair, note=str(error))
    logs = np.log(ours) - np.log(theirs)
    low, high = interval(logs)
    best = float(np.max(ours))
    return Row(
        pair=pair, value=1.0 / best if pair.unit == "s" else best,
        ratio=math.exp(logs.mean()), low=math.exp(low), high=math.exp(high),
    )  # fmt: skip


def number(value: float) -> str:
    """Return a number with three significant digits, with M for millions."""
    if value >= 1e5:
        return f"{value / 1e6:.2f} M"
    return f"{float(f'{value:.3g}'):,.0f}" if value >= 999.5 else f"{value:.3g}"


def interval(values: np.ndarray) -> tuple[float, float]:
    """Return the 95 % interval of the mean of ``values`` (n,), by the bootstrap."""
    if np.ptp(values) == 0.0:
        return float(values[0]), float(values[0])
    found = bootstrap((values,), np.mean, method="percentile", rng=np.random.default_rng(0))
    return float(found.confidence_interval.low), float(found.confidence_interval.high)
