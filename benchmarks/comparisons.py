"""False alarms and power of comparisons of navigators, from simulated tables.

    python -m benchmarks.comparisons [--tables N] [--part PART]

docs/statistics.md contains the output for 2,000 tables. The inference is that of
`benchnav.leaderboard.statistics.difference`; power is compared with sign flips of all worlds
on the same simulated values.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product

import numpy as np

from benchmarks.markdown_tables import print_parts
from benchnav.arrays import FloatArray
from benchnav.leaderboard.statistics.difference import Moments, difference
from benchnav.leaderboard.statistics.estimate import Column
from benchnav.leaderboard.statistics.interval import ALPHA
from benchnav.leaderboard.statistics.significance import holm, pairs
from studies.simulated_tables import CROWDS, EACH_FOR_ITSELF, Crowd, unit_rates, world_rates

TABLES = 2000
CHANCES = (0.5, 0.8, 0.9, 0.95, 0.98, 0.99)
FAMILY = 20
FALSE_ALARMS = 0.06  # upper limit
NEAR = 0.9  # share of FALSE_ALARMS above which a rate is measured again
AGAIN = 10  # factor of the number of tables in the second measurement
FLIPS = 9_999
FLOATS = 20_000_000  # largest number drawn at once


@dataclass(frozen=True)
class Design:
    """Scenarios × worlds; in every other scenario the first navigator is better by ``apart``."""

    scenarios: int
    worlds: int  # of each scenario
    apart: float = 0.0  # in the others it is worse by as much, so that the means are equal

    @property
    def name(self) -> str:
        """The name, ``5 × 20, ± 0.16``."""
        return f"{self.scenarios} × {self.worlds}{f', ± {self.apart:g}' if self.apart else ''}"

    def chances(self, chance: float, behind: float = 0.0) -> list[tuple[float, float]]:
        """Return both rates in each scenario; their mean is ``chance`` − ``behind`` / 2."""
        middle = chance - behind / 2
        reach = min(self.apart, (0.999 - middle) * 2 - behind) / 2
        sign = [(-1) ** s if s < self.scenarios // 2 * 2 else 0 for s in range(self.scenarios)]
        return [(middle + behind / 2 + k * reach, middle - behind / 2 - k * reach) for k in sign]


NULLS = (
    Design(1, 5), Design(1, 20), Design(1, 50), Design(5, 20), Design(5, 20, 0.16),
    Design(30, 2), Design(30, 2, 0.16), Design(10, 10, 0.16),
)  # fmt: skip
PAIRS = (*((crowd, crowd) for crowd in CROWDS[:4]), (CROWDS[3], EACH_FOR_ITSELF))
POWER = (  # design, rate of the first navigator, mean deficit of the second
    (Design(1, 10), 0.8, 0.4), (Design(1, 20), 0.8, 0.3), (Design(1, 50), 0.9, 0.15),
    (Design(1, 50), 0.99, 0.08), (Design(5, 20), 0.9, 0.1), (Design(5, 20), 0.99, 0.06),
    (Design(5, 20, 0.3), 0.8, 0.1), (Design(5, 20, 0.6), 0.7, 0.1), (Design(10, 5), 0.9, 0.12),
    (Design(30, 2), 0.9, 0.12), (Design(30, 2, 0.3), 0.8, 0.15), (Design(30, 10, 0.3), 0.8, 0.06),
)  # fmt: skip


def rate_differences(
    chances: list[tuple[float, float]], worlds: int, crowds: tuple[Crowd, Crowd], tables: int,
    rng: np.random.Generator,
) -> list[FloatArray]:  # fmt: skip
    """Return differences (n, T) of every scenario; ``crowds`` are those of the two navigators."""
    parts = []
    for one, other in chances:
        first, second = world_rates((one, other), crowds[0], (worlds, tables), rng)
        if crowds[1] != crowds[0]:
            (second,) = world_rates((other,), crowds[1], (worlds, tables), rng)
        parts.append(first - second)
    return parts


def p_values(parts: list[FloatArray], column: Column) -> FloatArray:
    """Return p-values (T,) by the inference of the leaderboard."""
    return difference([Moments.of(part) for part in parts], column).p


def rate_p(
    design: Design, chance: float, crowds: tuple[Crowd, Crowd], tables: int, behind: float = 0.0
) -> FloatArray:
    """Return p-values (T,), from values that are drawn in blocks that fit into memory."""
    rng = np.random.default_rng([3, design.scenarios, design.worlds])
    chances = design.chances(chance, behind)
    block = max(1, FLOATS // (2 * design.worlds * crowds[0].agents))
    sizes = [min(block, tables - start) for start in range(0, tables, block)]
    found = [
        p_values(rate_differences(chances, design.worlds, crowds, n, rng), unit_rates(n))
        for n in sizes
    ]
    return np.concatenate(found)


def called(p: FloatArray, family: int) -> float:
    """Return the share of families of independent comparisons with any significant one.

    The p-values of the comparisons are distributed like ``p``. In Holm's procedure, a family has
    a significant comparison exactly if the first step finds one.
    """
    return float(1.0 - (1.0 - np.mean(p < ALPHA / family)) ** family)


def alarms(design: Design, chance: float, crowds: tuple[Crowd, Crowd], tables: int) -> FloatArray:
    """Return false alarms of one comparison and of `FAMILY`, more exactly near the limit."""
    p = rate_p(design, chance, crowds, tables)
    shares = np.array([called(p, 1), called(p, FAMILY)])
    if (shares > NEAR * FALSE_ALARMS).any():
        p = rate_p(design, chance, crowds, AGAIN * tables)
        shares = np.array([called(p, 1), called(p, FAMILY)])
    return shares


SHAPES = {
    "normal": lambda rng, size: rng.standard_normal(size),
    "exponential": lambda rng, size: rng.standard_exponential(size),
    "log-normal": lambda rng, size: rng.lognormal(size=size),
    "SPL: 0 or near 0.9": lambda rng, size: (rng.random(size) < 0.85) * rng.beta(20, 2, size),
}


def mean_alarms(shape: str, design: Design, tables: int) -> FloatArray:
    """Return false alarms for means of other quantities, of equal distribution for both."""
    rng = np.random.default_rng([4, design.scenarios, design.worlds])
    size = (design.worlds, tables)
    parts = [SHAPES[shape](rng, size) - SHAPES[shape](rng, size) for _ in range(design.scenarios)]
    bounded = shape.startswith("SPL")
    ends = np.full(tables, 0.0 if bounded else -np.inf), np.full(tables, 1.0 if bounded else np.inf)
    p = p_values(parts, Column(np.zeros(tables, dtype=np.bool_), *ends))
    return np.array([called(p, 1), called(p, FAMILY)])


def table_alarms(entries: int, design: Design, chance: float, crowd: Crowd, tables: int) -> float:
    """Return the share of tables of equal entries with any significant difference."""
    rng = np.random.default_rng([5, entries, design.worlds])
    first, second = pairs(entries)
    parts = []
    for _ in range(design.scenarios):
        sides = np.array(world_rates([chance] * entries, crowd, (design.worlds, tables), rng))
        apart = sides[first] - sides[second]  # (C, n, T)
        parts.append(Moments.of(apart.transpose(1, 0, 2).reshape(design.worlds, -1)))
    p = difference(parts, unit_rates(len(first) * tables)).p.reshape(len(first), tables)
    return float(np.mean([(holm(column) < ALPHA).any() for column in p.T]))


def sign_flips(parts: list[FloatArray]) -> FloatArray:
    """Return p-values (T,) of the former inference: sign flips of all worlds."""
    value = np.concatenate([part / len(part) for part in parts])
    signs = np.random.default_rng(len(value)).choice((-1.0, 1.0), size=(FLIPS, len(value)))
    observed = np.abs(value.sum(axis=0)) - 1e-12 * np.abs(value).sum(axis=0)
    count = np.zeros(value.shape[1])
    for start in range(0, FLIPS, 500):
        count += (np.abs(signs[start : start + 500] @ value) >= observed).sum(axis=0)
    p: FloatArray = (1 + count) / (1 + FLIPS)
    return p


Row = tuple[str, ...]


def alarm_rows(tables: int) -> Iterator[Row]:
    """Yield false alarms of rates: of one comparison, and of a family of 20."""
    yield ("crowd of A; of B", "scenarios × worlds", *(f"{p:g}" for p in CHANCES), "as asked")
    for crowds, design in product(PAIRS, NULLS):
        found = np.array([alarms(design, p, crowds, 5 * tables) for p in CHANCES])
        name = "; ".join(dict.fromkeys(crowd.name for crowd in crowds))
        texts = (f"{one:.3f}, {many:.3f}" for one, many in found)
        yield (name, design.name, *texts, "yes" if found.max() <= FALSE_ALARMS else "no")


def shape_rows(tables: int) -> Iterator[Row]:
    """Yield false alarms of means of other quantities."""
    designs = (Design(1, 5), Design(1, 20), Design(1, 50), Design(5, 20), Design(30, 2))
    yield ("values of a world", *(design.name for design in designs))
    for shape in SHAPES:
        found = [mean_alarms(shape, design, 20 * tables) for design in designs]
        yield (shape, *(f"{one:.3f}, {many:.3f}" for one, many in found))


def table_rows(tables: int) -> Iterator[Row]:
    """Yield false alarms of whole tables of equal entries."""
    yield ("crowd", "entries", "scenarios × worlds", *(f"{p:g}" for p in CHANCES))
    for crowd, entries, design in product(CROWDS[2:4], (3, 10), (Design(1, 20), Design(5, 20))):
        shares = [table_alarms(entries, design, p, crowd, tables // 2) for p in CHANCES]
        yield (crowd.name, f"{entries}", design.name, *(f"{share:.3f}" for share in shares))


def power_rows(tables: int) -> Iterator[Row]:
    """Yield power by sign flips of all worlds, and by the leaderboard, on the same values."""
    yield (
        "crowd", "scenarios × worlds", "A", "B", "alone: flips", "now", f"one of {FAMILY}: flips",
        "now",
    )  # fmt: skip
    sums = []
    for crowd, (design, chance, behind) in product(CROWDS[:1] + CROWDS[2:4], POWER):
        rng = np.random.default_rng([6, design.scenarios, design.worlds])
        chances = design.chances(chance, behind)
        parts = rate_differences(chances, design.worlds, (crowd, crowd), tables, rng)
        both = (sign_flips(parts), p_values(parts, unit_rates(tables)))
        shares = [float(np.mean(p < ALPHA / m)) for m in (1, FAMILY) for p in both]
        sums.append(shares)
        rates = (f"{chance:g}", f"{chance - behind:g}")
        yield (crowd.name, design.name, *rates, *(f"{share:.3f}" for share in shares))
    yield ("mean", "", "", "", *(f"{share:.3f}" for share in np.mean(sums, axis=0)))


PARTS = {
    "false-alarms": alarm_rows, "other-quantities": shape_rows, "tables": table_rows,
    "power": power_rows,
}  # fmt: skip


if __name__ == "__main__":
    print_parts(__doc__.split("\n")[0], PARTS, TABLES)
