"""Entries with several trainings in the statistics: their mean, and their spread.

A value of an entry in a world is the mean over its trainings, so that the interval over worlds
holds for these trainings. Their spread shows what others may give. R. Agarwal et al., "Deep
reinforcement learning at the edge of the statistical precipice", NeurIPS 2021; P. Henderson et
al., "Deep reinforcement learning that matters", AAAI 2018.
"""

from __future__ import annotations

import math
import warnings
from collections import defaultdict
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from benchnav.arrays import FloatArray
from benchnav.leaderboard.statistics.interval import students, trimmed_mean
from benchnav.metrics.metric import Metric
from benchnav.navigation.plugin.trainings import entry_of

if TYPE_CHECKING:
    import pyarrow as pa

    from benchnav.leaderboard.statistics.strata import Stratum


@dataclass(frozen=True)
class Spread:
    """The means of single trainings over the same worlds."""

    count: int = 1
    least: float = math.nan
    most: float = math.nan
    deviation: float = math.nan  # standard deviation between trainings (n − 1)

    @classmethod
    def of(cls, means: FloatArray) -> Spread:
        """Return the spread of the means (K,) of K trainings; none of undefined means."""
        if len(means) < 2 or np.isnan(means).any():
            return cls(len(means))
        return cls(len(means), float(means.min()), float(means.max()), float(means.std(ddof=1)))

    @property
    def of_two(self) -> float:
        """How much two trainings of this recipe may differ, in 95 % of cases.

        The half-width of the prediction interval of a difference of two new normal values.
        """
        if math.isnan(self.deviation):
            return math.nan
        return float(students(np.array([self.count - 1.0]))[0]) * math.sqrt(2.0) * self.deviation


def with_entries(results: pa.Table) -> pa.Table:
    """Return results (RESULTS) with the names of entries in place of their trainings' labels."""
    import pyarrow as pa
    import pyarrow.compute as pc

    labels = results["navigator"].unique().to_pylist()
    entries = [entry_of(label) for label in labels]
    if entries == labels:
        return results
    column = results["navigator"].cast(pa.string())
    place = pc.index_in(column, value_set=pa.array(labels, pa.string()))
    named = pa.chunked_array([pa.array(entries, pa.string()).take(place.combine_chunks())])
    return results.set_column(results.column_names.index("navigator"), "navigator", named)


def pooled(
    s: Stratum, trainings: Mapping[str, Sequence[str]], metrics: Mapping[str, Metric]
) -> Stratum:
    """Return the stratum with one navigator for each entry.

    ``trainings`` are the labels of each entry that has several. A world counts as attempted if all
    of them attempted it, and as failed if one of them failed. Conditional metrics, such as the time
    to a goal, are means over the trainings that define them; others need a value of each.
    """
    held = {
        entry: [s.navigators.index(label) for label in labels if label in s.navigators]
        for entry, labels in trainings.items()
    }
    held = {entry: places for entry, places in held.items() if places}
    if not held:
        return s
    pooled_labels = {label for entry in held for label in trainings[entry]}
    names = sorted([*(n for n in s.navigators if n not in pooled_labels), *held])
    groups = [held.get(name) or [s.navigators.index(name)] for name in names]
    whole = [len(trainings.get(name, [name])) for name in names]
    complete = np.array([len(g) for g in groups]) == whole
    conditional = np.array([_is_conditional(metrics.get(name)) for name in s.metrics], dtype=bool)
    return replace(
        s,
        navigators=tuple(names),
        value=np.stack([_mean(s.value[:, g], conditional) for g in groups], axis=1),
        agents=np.stack([s.agents[:, g].sum(axis=1) for g in groups], axis=1),
        attempted=np.stack([s.attempted[:, g].all(axis=1) for g in groups], axis=1) & complete,
        failed=np.stack([s.failed[:, g].any(axis=1) for g in groups], axis=1),
        granted=np.array([s.granted[g].max() for g in groups], np.int64),
        cost=np.stack([s.cost[:, g].mean(axis=1) for g in groups], axis=1),
        trainings={entry: s.value[:, places] for entry, places in held.items()},
    )


def trainings_of(labels: Collection[str], apart: Collection[str] = ()) -> dict[str, list[str]]:
    """Return entry → labels, sorted, of the entries with several trainings, without ``apart``."""
    found = defaultdict(list)
    for label in sorted(labels):
        if label not in apart and entry_of(label) != label:
            found[entry_of(label)].append(label)
    return dict(found)


def spread_of(
    group: Sequence[Stratum], navigator: str, metric: str, quartiles: bool = False
) -> Spread:
    """Return the spread of a navigator's trainings over strata with equal weights.

    ``quartiles``: of interquartile means over the strata instead of means.
    """
    means = []
    for s in group:
        if navigator in s.trainings and metric in s.metrics:
            values = s.trainings[navigator][:, :, s.metrics.index(metric)]  # (S, K)
            means.append(_nan_mean(values[~np.isnan(values).all(axis=1)], 0))
    if not means:
        return Spread()
    return Spread.of(trimmed_mean(np.array(means), 0.25 if quartiles else 0.0))


def _is_conditional(metric: Metric | None) -> bool:
    return metric is not None and metric.conditional


def _mean(values: FloatArray, conditional: np.ndarray) -> FloatArray:
    """Return the mean (S, M) over trainings of values (S, K, M)."""
    if values.shape[1] == 1:
        return values[:, 0]
    found: FloatArray = np.where(conditional, _nan_mean(values, 1), values.mean(axis=1))
    return found


def _nan_mean(values: FloatArray, axis: int) -> FloatArray:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # of an empty mean, which is NaN
        found: FloatArray = np.nanmean(values, axis=axis)
    return found
