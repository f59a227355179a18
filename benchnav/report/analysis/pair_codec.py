"""Comparisons of two navigators as compact lists of numbers, for the script of the page."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from benchnav.leaderboard.record import ALL
from benchnav.leaderboard.rendering.digits import RATE_DECIMALS
from benchnav.leaderboard.statistics.comparison import Comparison, least_worlds
from benchnav.leaderboard.statistics.head_to_head import Duel
from benchnav.metrics.metric import Metric
from benchnav.scenario.condition import condition

FIGURES = 5  # of a number
VERDICTS = (
    "better", "worse", "higher", "lower", "tie", "too few worlds", "no common world",
    "not as equals",
)  # fmt: skip
Place = tuple[str, str, str, str]
"""Scenario ("" for all), condition, role, split."""


@dataclass(eq=False)
class PairCodec:
    """Encodes comparisons; collects the places where they were made."""

    metrics: Sequence[str]
    places: dict[Place, int] = field(default_factory=dict)

    def pair(self, duel: Duel, notes: Sequence[Sequence[str]]) -> dict[str, Any]:
        """Return the comparisons of a pair: a list of 8 numbers for each.

        These are the indices of metric and place, the number of worlds, the difference, both ends
        of its interval, p after Holm's correction, and the index of the verdict. ``notes`` are
        those of each condition.
        """
        family = max((c.family for c in duel.comparisons), default=0)
        rows = [self._row(c) for c in duel.comparisons]
        needed = least_worlds(family)
        return {"family": family, "needed": needed, "notes": notes, "rows": rows}

    def _row(self, c: Comparison) -> list[float | None]:
        where = condition(c.track, c.perception)
        place = "" if c.scenario == ALL else c.scenario, where, c.role, c.split
        index = self.places.setdefault(place, len(self.places))
        numbers = (rounded(x) for x in (c.difference, c.low, c.high, c.adjusted))
        metric = self.metrics.index(c.metric)
        return [metric, index, c.worlds, *numbers, VERDICTS.index(c.verdict)]


def rounded(number: float) -> float | None:
    """Return a number with `FIGURES` figures; None for an unknown one."""
    if not math.isfinite(number):
        return None
    return 0.0 if number == 0.0 else float(f"{number:.{FIGURES - 1}e}")


def metric_fields(metric: Metric) -> Mapping[str, Any]:
    """Return what the page needs to know of a metric."""
    among = ", among agents that arrive" if metric.conditional else ""
    return {
        "name": metric.name, "title": f"{metric.title}{among}", "better": metric.better,
        "unit": metric.unit, "decimals": RATE_DECIMALS if metric.rate else 0,
    }  # fmt: skip
