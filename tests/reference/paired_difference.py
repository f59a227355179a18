"""The inference of paired differences over fixed scenarios, one number at a time.

The slow twin of `benchnav.leaderboard.statistics.difference`. It reads like docs/statistics.md.
"""

import math
import statistics
from dataclasses import dataclass

from scipy import optimize, stats

EVENTS = 2.0
UNSEEN = 0.5


@dataclass(frozen=True)
class Inference:
    """A mean difference, and the distribution that its error is judged by."""

    value: float
    error: float  # standard error
    freedom: float
    skewness: float

    def p(self, null: float = 0.0) -> float:
        """Two-sided p-value of ``null`` being the true difference."""
        t = (self.value - null) / self.error
        against = max(0.0, -math.copysign(1.0, t) * self.skewness)
        worth = abs(t)
        if against and worth:
            worth = optimize.brentq(
                lambda w: w + against * w**2 / 3 - abs(t), 0.0, abs(t), xtol=1e-15
            )
        return float(2 * stats.t.sf(worth, self.freedom))

    def interval(self) -> tuple[float, float]:
        """Both ends, where p is 0.05, by search."""
        far = 1e4 * self.error
        low, high = (
            optimize.brentq(
                lambda d: self.p(self.value + d) - 0.05, *sorted((0.0, side * far)), xtol=1e-13
            )
            for side in (-1, 1)
        )
        return self.value + low, self.value + high


def inference(scenarios: list[list[float]], width: float) -> Inference:
    """Of the differences of the worlds of each scenario; ``width`` is the metric's range or ∞."""
    scenarios = [worlds for worlds in scenarios if worlds]
    share = 1 / len(scenarios)
    value = sum(share * statistics.fmean(worlds) for worlds in scenarios)
    variance, quarter, third, most, singles = 0.0, 0.0, 0.0, 0, 0
    squares, sizes, usual = 0.0, 0.0, 0.0
    for worlds in scenarios:
        n, middle = len(worlds), statistics.fmean(worlds)
        weight = share / n
        usual += n * weight**2
        if n == 1:
            part = share**2 * (middle - value) ** 2 * len(scenarios) / (len(scenarios) - 1)
            freedom, singles = 1, singles + 1
        else:
            part = share**2 * statistics.variance(worlds) / n
            freedom = n - 1
            squares += n * weight**2 * statistics.variance(worlds)
        variance += part
        quarter += part**2 / (freedom + 2)
        most += freedom
        if n > 2:
            cubes = sum((x - middle) ** 3 for x in worlds)
            third += share**3 * cubes / (n * (n - 1) * (n - 2))
        sizes += weight * sum(abs(x - middle) for x in worlds)
    most -= singles == len(scenarios)
    freedom = min(max(variance**2 / quarter - 2, 1.0), most) if variance else float(most)
    event, largest = 0.0, max(abs(x) for worlds in scenarios for x in worlds)
    whole = usual * (width if not largest and math.isfinite(width) else largest)
    if whole and (math.isfinite(width) or not variance):
        event = (squares + UNSEEN * whole**2) / (sizes + UNSEEN * whole)
    error = math.sqrt(variance + EVENTS * event**2)
    return Inference(value, error, freedom, third / error**3 if error else 0.0)
