"""The failed episodes of the runs, and which of them get a replay."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import pyarrow.compute as pc

from benchnav.scenario.condition import condition

if TYPE_CHECKING:
    import pyarrow as pa

SUCCESS = "success"
CAUSES = {
    "collided": "collided", "timeout": "timed out", "stuck": "got stuck",
    "failed": "the navigator failed",
}  # fmt: skip
"""Metrics that say why agents did not succeed → words."""
Cell = tuple[str, str, str, str]  # navigator, scenario, track, perception


@dataclass(frozen=True)
class Failures:
    """The failed episodes of a navigator in a scenario and condition."""

    navigator: str
    scenario: str
    track: str
    perception: str
    failed: int  # episodes in which an evaluated agent did not succeed
    episodes: int
    seed: int  # of the first failed episode
    causes: tuple[str, ...]  # why its agents did not succeed

    @property
    def cell(self) -> Cell:
        """Navigator, scenario, track and perception."""
        return self.navigator, self.scenario, self.track, self.perception


def find_failures(results: pa.Table) -> list[Failures]:
    """Return the cells with failed episodes, in the order of the results.

    ``results`` has the schema `benchnav.store.parts.results.RESULTS`.
    """
    success = _worst(results, SUCCESS, lowest=True)
    causes = {name: _worst(results, name, lowest=False) for name in CAUSES}
    found = []
    for cell, values in success.items():
        lost = sorted(seed for seed, value in values.items() if value < 1.0)
        if not lost:
            continue
        first = lost[0]
        why = (words for name, words in CAUSES.items() if causes[name][cell].get(first, 0.0) > 0.0)
        found.append(Failures(*cell, len(lost), len(values), first, tuple(why)))
    return found


def _worst(results: pa.Table, metric: str, *, lowest: bool) -> defaultdict[Cell, dict[int, float]]:
    """Return the worst value over the roles of each episode: cell → seed → value."""
    rows = results.filter(pc.equal(results["metric"], metric))
    rows = rows.filter(pc.invert(pc.is_nan(rows["value"])))
    found: defaultdict[Cell, dict[int, float]] = defaultdict(dict)
    names = ("navigator", "scenario", "track", "perception", "seed", "value")
    for *cell, seed, value in zip(*(rows[name].to_pylist() for name in names), strict=True):
        values = found[cell[0], cell[1], cell[2], cell[3]]
        held = values.get(seed, value)
        values[seed] = min(held, value) if lowest else max(held, value)
    return found


def choose_replays(failures: Iterable[Failures], most: int) -> list[Failures]:
    """Return at most ``most`` cells whose first failed episode gets a replay.

    They are spread evenly over the navigators, scenarios and conditions that have failures.
    """
    left = list(failures)
    count: Counter[tuple[str, str]] = Counter()
    chosen: list[Failures] = []
    while left and len(chosen) < most:
        best = min(left, key=lambda f: _shares(f, count))
        left.remove(best)
        chosen.append(best)
        count.update(_parts(best))
    return chosen


def _parts(f: Failures) -> tuple[tuple[str, str], ...]:
    where = condition(f.track, f.perception)
    return ("navigator", f.navigator), ("scenario", f.scenario), ("condition", where)


def _shares(f: Failures, count: Mapping[tuple[str, str], int]) -> tuple[int, int]:
    navigator, scenario, where = (count[part] for part in _parts(f))
    return navigator + scenario, where
