"""Strata: rows of results as dense arrays, one per set of episodes that may be compared."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from hashlib import sha256
from typing import TYPE_CHECKING, Any

import numpy as np

from benchnav.arrays import AnyArray, BoolArray, FloatArray, IntArray
from benchnav.errors import UsageError
from benchnav.leaderboard.statistics.trainings import pooled, trainings_of
from benchnav.metrics.metric import Metric

if TYPE_CHECKING:
    import pyarrow as pa

KEYS = ("split", "track", "perception", "role", "scenario", "scenario_hash", "horizon", "dt")
GRANT = "rehearsal"  # the key that separates entries with different numbers of rehearsals
COSTS = ("rehearsal_decisions", "rehearsal_seconds")
MIXED = -1  # replaces the number if entries with different grants are together


@dataclass(frozen=True, eq=False)
class Stratum:
    """Episodes with the same split, condition, role, scenario, geometry, horizon, step and grant.

    S seeds, N navigators, M metrics.
    """

    split: str
    track: str
    perception: str
    role: str
    scenario: str
    scenario_hash: str
    horizon: float
    dt: float
    rehearsal: int  # rehearsals granted to all entries; `MIXED`: see granted
    navigators: tuple[str, ...]  # (N,) sorted
    metrics: tuple[str, ...]  # (M,) sorted
    seeds: IntArray  # (S,) sorted
    value: FloatArray  # (S, N, M) NaN where undefined
    agents: FloatArray  # (S, N, M) agents over which a value is taken
    attempted: BoolArray  # (S, N)
    failed: BoolArray  # (S, N) the navigator failed
    granted: IntArray  # (N,) rehearsals
    cost: FloatArray  # (S, N, 2) decisions and seconds [s] of rehearsals; NaN if not attempted
    trainings: Mapping[str, FloatArray] = field(default_factory=dict)
    """(S, K, M) values of the K trainings of navigators that have several."""

    def rng(self, purpose: str) -> np.random.Generator:
        """Return a generator of this scenario, equal in every condition and table."""
        own = (self.scenario, self.scenario_hash, self.horizon, self.dt)
        key = "\0".join([purpose, *map(str, own)])
        return np.random.default_rng(list(sha256(key.encode()).digest()))


def strata(
    results: pa.Table,
    metrics: Mapping[str, Metric],
    mixed: bool = False,
    apart: Collection[str] = (),
) -> list[Stratum]:
    """Return every stratum, sorted by its key, for any order of the rows (RESULTS).

    ``mixed`` combines entries with different numbers of rehearsals: they may be
    compared in texts that name the numbers, and are never ranked. The trainings of an entry become
    one navigator, except the labels ``apart``.

    Raises UsageError if one navigator has two values in one world.
    """
    rows = results.num_rows
    columns = {name: _encode(results[name]) for name in (*KEYS, "navigator", "metric", "seed")}
    numbers = {name: results[name].to_numpy() for name in ("value", "defined")}
    numbers["failed"] = _failed(results["failure"])
    for name in (GRANT, *COSTS):
        numbers[name] = _filled(results, name)
    if not mixed:
        grants, code = np.unique(numbers[GRANT], return_inverse=True)
        columns[GRANT] = code.astype(np.int64), grants.tolist()
    codes = np.zeros(rows, dtype=np.int64)
    for name in KEYS if mixed else (*KEYS, GRANT):
        code, known = columns[name]
        if len(known) > 1:
            codes = np.unique(codes * len(known) + code, return_inverse=True)[1]
    order = np.argsort(codes, kind="stable")
    ends = np.flatnonzero(np.diff(codes[order])) + 1
    parts = np.split(order, ends) if rows else []
    several = trainings_of(columns["navigator"][1], apart)
    found = [pooled(_stratum(part, columns, numbers, metrics), several, metrics) for part in parts]
    return sorted(found, key=lambda s: tuple(getattr(s, name) for name in (*KEYS, GRANT)))


def _encode(column: Any) -> tuple[IntArray, list[Any]]:
    """Return codes (rows,) and the sorted values of the codes."""
    import pyarrow.compute as pc

    encoded = pc.dictionary_encode(column).combine_chunks()
    if hasattr(encoded, "chunks"):
        encoded = encoded.chunk(0)
    values = encoded.dictionary.to_pylist()
    order = sorted(range(len(values)), key=lambda i: values[i])
    place = np.empty(len(values), dtype=np.int64)
    place[order] = np.arange(len(values))
    return place[encoded.indices.to_numpy()], [values[i] for i in order]


def _failed(column: Any) -> BoolArray:
    import pyarrow.compute as pc

    failed: BoolArray = pc.not_equal(pc.fill_null(column, ""), "").to_numpy()
    return failed


def _filled(results: pa.Table, name: str) -> AnyArray:
    """Return a column (rows,) with 0 if it is missing (older results) or empty."""
    import pyarrow.compute as pc

    if name not in results.column_names:
        return np.zeros(results.num_rows, np.int64)
    filled: AnyArray = pc.fill_null(results[name], 0).to_numpy()
    return filled


def _stratum(
    part: IntArray,
    columns: Mapping[str, tuple[IntArray, list[Any]]],
    numbers: Mapping[str, AnyArray],
    metrics: Mapping[str, Metric],
) -> Stratum:
    names = [name for name in (*KEYS, GRANT) if name in columns]
    key = {GRANT: MIXED} | {n: columns[n][1][int(columns[n][0][part[0]])] for n in names}
    at, axes = [], []
    for name in ("seed", "navigator", "metric"):
        code, values = columns[name]
        present, place = np.unique(code[part], return_inverse=True)
        at.append(place)
        axes.append([values[int(i)] for i in present])
    shape = tuple(len(axis) for axis in axes)
    flat = np.ravel_multi_index(tuple(at), shape)
    kept, settled = _settle(numbers["value"][part], flat, axes, metrics)
    value = np.full(shape, np.nan)
    agents = np.zeros(shape)
    value.ravel()[flat[kept]] = settled
    agents.ravel()[flat[kept]] = numbers["defined"][part[kept]]
    attempted = np.zeros(shape[:2], dtype=np.bool_)
    failed = np.zeros(shape[:2], dtype=np.bool_)
    attempted[at[0], at[1]] = True
    broken = numbers["failed"][part]
    failed[at[0][broken], at[1][broken]] = True
    _charge(value, agents, failed, axes[2], metrics)
    granted = np.zeros(shape[1], np.int64)
    granted[at[1]] = numbers[GRANT][part]
    cost = np.full((*shape[:2], len(COSTS)), np.nan)
    for k, name in enumerate(COSTS):
        cost[at[0], at[1], k] = numbers[name][part]
    return Stratum(
        **key, navigators=tuple(axes[1]), metrics=tuple(axes[2]),
        seeds=np.array(axes[0], dtype=np.int64),
        value=value, agents=agents, attempted=attempted, failed=failed, granted=granted, cost=cost,
    )  # fmt: skip


def _settle(
    value: FloatArray, flat: IntArray, axes: list[list[Any]], metrics: Mapping[str, Metric]
) -> tuple[IntArray, FloatArray]:
    """Return one row (K,) per cell, and the value (K,) that counts for it.

    Rows that repeat an episode count once; timings of repeated runs are averaged.
    """
    order = np.lexsort((value, flat))  # NaN comes last
    cell, first, count = np.unique(flat[order], return_index=True, return_counts=True)
    settled = value[order[first]].astype(np.float64)
    greatest = value[order[first + count - 1]]
    same = (settled == greatest) | (np.isnan(settled) & np.isnan(greatest))
    for i in np.flatnonzero(~same):
        at = np.unravel_index(int(cell[i]), [len(axis) for axis in axes])
        seed, navigator, metric = (axis[int(k)] for axis, k in zip(axes, at, strict=True))
        if metric not in metrics or metrics[metric].verifiable:
            raise UsageError(
                f"A navigator must have one value in one world, but {navigator!r} has"
                f" {settled[i]:.6g} and {greatest[i]:.6g} for {metric!r} at seed {seed}."
                " Give runs of differently configured navigators different labels."
            )
        settled[i] = float(np.nanmean(value[order[first[i] : first[i] + count[i]]]))
    return order[first], settled


def _charge(
    value: FloatArray,
    agents: FloatArray,
    failed: BoolArray,
    names: list[str],
    metrics: Mapping[str, Metric],
) -> None:
    """Set the values of failed episodes to the worst value of their metric.

    The value is undefined if there is no worst, or if the metric is conditional on
    arrival or undefined in that world for all navigators; it is kept if the metric only describes.
    """
    for m, name in enumerate(names):
        metric = metrics.get(name)
        if metric is None or metric.better is None:
            continue
        worst = metric.low if metric.better == "higher" else metric.high
        known = ~np.isnan(value[:, :, m])
        owed = failed & (metric.rate | known.any(axis=1, keepdims=True))
        possible = np.isfinite(worst) and not metric.conditional
        value[:, :, m][failed] = np.nan
        value[:, :, m][owed] = worst if possible else np.nan
        agents[:, :, m][owed] = np.maximum(agents[:, :, m].max(initial=1.0), 1.0)


def align(group: list[Stratum]) -> list[Stratum]:
    """Return strata with the same navigators and metrics; missing ones count as unattempted."""
    navigators = tuple(sorted({name for s in group for name in s.navigators}))
    metrics = tuple(sorted({name for s in group for name in s.metrics}))
    aligned = []
    for s in group:
        n = np.searchsorted(navigators, s.navigators)
        m = np.searchsorted(metrics, s.metrics)
        shape = (len(s.seeds), len(navigators), len(metrics))
        value, agents = np.full(shape, np.nan), np.zeros(shape)
        value[:, n[:, None], m], agents[:, n[:, None], m] = s.value, s.agents
        attempted, failed = np.zeros(shape[:2], bool), np.zeros(shape[:2], bool)
        attempted[:, n], failed[:, n] = s.attempted, s.failed
        granted = np.zeros(len(navigators), np.int64)
        cost = np.full((*shape[:2], s.cost.shape[2]), np.nan)
        granted[n], cost[:, n] = s.granted, s.cost
        trainings = {}
        for name, values in s.trainings.items():
            trainings[name] = np.full((*values.shape[:2], len(metrics)), np.nan)
            trainings[name][:, :, m] = values
        aligned.append(
            replace(
                s, navigators=navigators, metrics=metrics, value=value, agents=agents,
                attempted=attempted, failed=failed, granted=granted, cost=cost,
                trainings=trainings,
            )
        )  # fmt: skip
    return aligned
