"""Times and memory: read from the record, undefined where they were not taken."""

import math
from dataclasses import replace

import numpy as np
import pytest

from benchnav.metrics.measure import load_metric, measure
from benchnav.testing.zoo import zoo

NAMES = ("latency_p50", "latency_p95", "latency_p99", "peak_memory")


def _values(**timings):
    episode = zoo()["errand"]
    changed = replace(episode, timings=replace(episode.timings, **timings))
    rows = measure(changed, [load_metric(name) for name in NAMES])
    return [row["value"] for row in rows]


def test_latency_is_that_of_a_world_alone():
    taken = np.random.default_rng(0).permutation(np.arange(101) * 1e-3)
    assert _values(latency=taken, memory=3 << 20) == pytest.approx([0.05, 0.095, 0.099, 3 << 20])


def test_what_was_not_taken_is_undefined():
    assert all(map(math.isnan, _values(latency=None, memory=None)))
    assert all(map(math.isnan, _values(latency=np.zeros(0), memory=None)))


def test_latency_ranks_and_batched_times_describe():
    ranked = {name for name in NAMES if load_metric(name).better == "lower"}
    assert ranked == {"latency_p50", "latency_p95", "latency_p99"}
    for name in ("decision_time_p50", "decision_time_p95", "decision_time_p99"):
        assert load_metric(name).better is None
        assert not load_metric(name).verifiable
