"""The measured values of a run, as numbers with intervals and as paired differences."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchnav.arrays import FloatArray
from benchnav.episode.episode import Episode
from benchnav.errors import UsageError
from benchnav.leaderboard.statistics.difference import Moments, difference
from benchnav.leaderboard.statistics.estimate import Estimate, Sample, columns_of, estimate
from benchnav.leaderboard.statistics.interval import ALPHA, mid_p, resample
from benchnav.metrics.measure import all_metrics
from benchnav.metrics.metric import Metric
from benchnav.store.parts.part import Part, parts_of
from benchnav.store.runs.manifest import Manifest, load_manifest
from benchnav.store.runs.reading import read_results
from benchnav.store.runs.run_folder import RunFolder

Cell = tuple[str, str, str]  # scenario without version, track, navigator


@dataclass(frozen=True)
class Value:
    """A mean over worlds, with its 95 % interval."""

    mean: float  # NaN: nothing was measured
    low: float
    high: float
    worlds: int

    def text(self, scale: float = 1.0, digits: int = 1) -> str:
        """``98.2 [97.4, 98.8]``; ``–`` where nothing was measured."""
        if math.isnan(self.mean):
            return "–"
        mean, low, high = (_rounded(scale * x, digits) for x in (self.mean, self.low, self.high))
        return mean if math.isnan(self.low) else f"{mean} [{low}, {high}]"


@dataclass(frozen=True)
class Difference(Value):
    """A mean of paired differences, with the p-value of none."""

    p: float

    @property
    def sure(self) -> bool:
        """Whether the interval excludes zero, which is where p is below 0.05."""
        return self.p < ALPHA

    def text(self, scale: float = 1.0, digits: int = 1) -> str:
        """Signed: ``−3.1 [−4.0, −2.2]``."""
        plain = super().text(scale, digits)
        return f"+{plain}" if self.mean > 0.0 and not plain.startswith("0.0 ") else plain


@dataclass(frozen=True)
class Evidence:
    """Per cell, role and metric: (seed → (value, agents))."""

    run: Path
    manifest: Manifest
    values: Mapping[tuple[Cell, str, str], Mapping[int, tuple[float, int]]]
    reasons: Mapping[Cell, str]  # of cells that are n/a

    @classmethod
    def of(cls, run: Path) -> "Evidence":
        """Of a run folder. Raises StoreError where it is none."""
        manifest = load_manifest(run)
        values: dict[tuple[Cell, str, str], dict[int, tuple[float, int]]] = {}
        table = read_results(run)
        names = ("scenario", "track", "navigator", "role", "metric", "seed", "value", "defined")
        for scenario, track, navigator, role, metric, seed, value, agents in zip(
            *(table[name].to_pylist() for name in names), strict=True
        ):
            cell = (scenario.partition("@")[0], track, navigator)
            values.setdefault((cell, role, metric), {})[seed] = (value, agents)
        reasons = {
            (c["scenario"].partition("@")[0], c["track"], c["navigator"]): c["reason"]
            for c in manifest.cells
            if c["reason"]
        }
        return cls(run, manifest, values, reasons)

    def value(self, metric: str, cell: Cell, role: str = "leader") -> Value:
        """The mean of a metric in a cell over its worlds."""
        held = self._held(metric, cell, role)
        values = np.array([[v] for v, _ in held.values()])
        agents = np.array([[float(n)] for _, n in held.values()])
        return Value(*_interval(metric, values, agents), len(held))

    def difference(self, metric: str, cell: Cell, other: Cell, role: str = "leader") -> Difference:
        """``cell`` − ``other`` over the seeds of both.

        Where the two are different scenarios their worlds are not the same, and equal
        seeds are paired as any others would be.
        """
        mine, theirs = self._held(metric, cell, role), self._held(metric, other, role)
        seeds = sorted(mine.keys() & theirs.keys())
        apart = np.array([mine[seed][0] - theirs[seed][0] for seed in seeds]).reshape(-1, 1)
        found = difference([Moments.of(apart)], columns_of([_metric(metric)]))
        numbers = (float(x[0]) for x in (found.value, found.low, found.high))
        return Difference(*numbers, int(found.worlds[0]), float(found.p[0]))

    def alike(self, metric: str, cells: Sequence[Cell]) -> bool:
        """True where all of these cells were run and have the same value in every world."""
        first, *others = (dict(self._held(metric, cell, "leader")) for cell in cells)
        return bool(first) and all(first == other for other in others)

    def episodes(self, cell: Cell) -> Iterator[Episode]:
        """The stored episodes of a cell, by seed."""
        for part in self._parts(cell):
            yield from part.episodes()

    def rehearsals(self, cell: Cell) -> Iterator[Episode]:
        """The rehearsals before them."""
        for part in self._parts(cell):
            yield from part.rehearsals()

    def _parts(self, cell: Cell) -> list[Part]:
        folder = RunFolder(self.run, self.manifest)
        return [
            part
            for c in self.manifest.cells
            if (c["scenario"].partition("@")[0], c["navigator"]) == (cell[0], cell[2])
            and cell[1] in (c["track"], *c.get("also", ()))
            for part in parts_of(folder.cell(c["key"]))
        ]

    def _held(self, metric: str, cell: Cell, role: str) -> Mapping[int, tuple[float, int]]:
        held = self.values.get((cell, role, metric))
        if held is None and cell not in self.reasons:
            raise UsageError(
                f"The run must hold {metric!r} of {' / '.join(cell)} ({role}s)."
                f" {self.run} does not: it must be a whole run of the suite 'paper'."
            )
        return held or {}


def _interval(metric: str, values: FloatArray, agents: FloatArray) -> tuple[float, float, float]:
    if not len(values) or np.isnan(values).all():
        return math.nan, math.nan, math.nan
    about = _metric(metric)
    if not np.nansum(np.abs(values)) and math.isinf(about.high):
        # no event at all: as if each world could have had one, for counts have no bound
        return 0.0, 0.0, float(mid_p(np.zeros(1), np.array([float(len(values))]))[1][0])
    return _only(estimate(Sample(values, agents, _weights(len(values))), columns_of([about])))


def _metric(name: str) -> Metric:
    return next(metric for metric in all_metrics() if metric.name == name)


def _weights(count: int) -> FloatArray:
    return resample(count, np.random.default_rng(count))


def _only(found: Estimate) -> tuple[float, float, float]:
    return float(found.value[0]), float(found.low[0]), float(found.high[0])


def _rounded(value: float, digits: int) -> str:
    text = f"{value:.{digits}f}"
    return text[1:] if text.startswith("-") and not float(text) else text.replace("-", "−")
