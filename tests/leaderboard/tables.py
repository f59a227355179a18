"""Made-up results for the tests, and the slow twins of what they are compared with."""

import math

import numpy as np
import pyarrow as pa

from benchnav.metrics.metric import Metric
from benchnav.store.parts.results import RESULTS


def _nothing(episode):
    raise AssertionError("a leaderboard never computes a metric")


def metric(name, better="higher", low=0.0, high=math.inf, unit="", **flags):
    return Metric(
        name=name, title=name, unit=unit, better=better, low=low, high=high,
        reference="tests", function=_nothing, **flags,
    )  # fmt: skip


METRICS = {
    m.name: m
    for m in (
        metric("success", high=1.0, rate=True),
        metric("collided", "lower", high=1.0, rate=True),
        metric("spl", high=1.0),
        metric("time_to_goal", "lower", unit="s", conditional=True),
        metric("turning", "lower", unit="rad/m"),
        metric("latency_p50", "lower", unit="s", verifiable=False),
        metric("path_length", None, unit="m"),
    )
}


def row(navigator, seed, metric, value, **changes):
    """One row of RESULTS."""
    return {
        "navigator": navigator, "scenario": "leaders/static@1", "scenario_hash": "c0ffee00",
        "track": "unknown", "split": "test", "seed": seed, "role": "leader", "metric": metric,
        "value": value, "agents": 4, "defined": 0 if math.isnan(value) else 4, "failure": "",
        "horizon": 60.0, "dt": 0.1, "perception": "exact", **changes,
    }  # fmt: skip


def table(rows):
    return pa.Table.from_pylist(rows, schema=RESULTS)


def scores(values, metric="success", **changes):
    """Rows from navigator → values, one a seed; None is a world that was not attempted."""
    return [
        row(navigator, seed, metric, float(value), **changes)
        for navigator, column in values.items()
        for seed, value in enumerate(column)
        if value is not None
    ]


def simulated(navigators, scenarios, seeds, rng, tracks=("unknown",)):
    """Rows of every metric in METRICS: navigators differ in skill, worlds in difficulty."""
    rows = []
    for track in tracks:
        for s in range(scenarios):
            hard = rng.normal(0.0, 0.6, seeds) + s * 0.3
            for n, name in enumerate(navigators):
                chance = 1 / (1 + np.exp(-(1.5 - 0.8 * n - hard)))
                won = rng.binomial(4, chance) / 4
                hit = rng.binomial(4, 1 - chance) / 4
                times = np.where(won > 0, rng.gamma(20, 1.0 + 0.1 * n, seeds), np.nan)
                columns = {
                    "success": won, "collided": hit, "spl": won * rng.uniform(0.7, 1.0, seeds),
                    "time_to_goal": times, "turning": rng.gamma(2.0, 0.1 + 0.05 * n, seeds),
                    "latency_p50": rng.lognormal(-9 + n, 0.2, seeds),
                    "path_length": rng.normal(20.0, 2.0, seeds),
                }  # fmt: skip
                place = {"scenario": f"leaders/s{s}@1", "track": track, "scenario_hash": f"{s:08x}"}
                for metric, values in columns.items():
                    rows += scores({name: values}, metric, **place)
    return rows
