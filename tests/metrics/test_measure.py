"""Rows of the results table, and what several metrics share."""

import gc
import math
import re
import weakref
from dataclasses import replace

import numba
import numpy as np
import pyarrow as pa
import pytest

from benchnav.arena.agents import Role
from benchnav.errors import PluginError
from benchnav.geometry import geodesic
from benchnav.kernels import kernel
from benchnav.metrics.measure import all_metrics, load_metric, measure
from benchnav.metrics.metric import Metric
from benchnav.metrics.quantities.episode_analysis import analyse
from benchnav.plugins import METRICS
from benchnav.store.parts.results import RESULTS
from benchnav.testing.episodes import Setting, Walk, record, straight
from benchnav.testing.zoo import smooth, zoo


def _metric(function, name="x", **flags):
    return Metric(
        name=name, title="t", unit="", better="higher", low=0.0, high=1.0, reference="r",
        function=function, **flags,
    )  # fmt: skip


def test_rows_are_those_of_the_results_table():
    rows = measure(zoo()["smooth"], all_metrics())
    table = pa.Table.from_pylist(rows, schema=RESULTS)
    assert table.num_rows == 2 * len(METRICS.names())
    assert set(rows[0]) == set(RESULTS.names)
    assert table.column("role").unique().to_pylist() == ["leader", "follower"]
    assert table.column("agents").unique().to_pylist() == [2, 3]
    one = next(r for r in rows if r["metric"] == "success" and r["role"] == "leader")
    assert (one["value"], one["defined"], one["horizon"], one["dt"]) == (0.5, 2, 12.0, 0.1)


def test_background_agents_are_never_scored():
    walks = [
        Walk(straight((0.0, 0.0), (0.0, 0.0)), (5.0, 0.0)),
        Walk(straight((0.0, 3.0), (1.0, 0.0)), (5.0, 3.0), driver=1, role=Role.FOLLOWER),
    ]
    rows = measure(record(walks), [load_metric("arrival")])
    assert [(r["role"], r["value"], r["agents"]) for r in rows] == [("leader", 0.0, 1)]


def test_mean_is_over_the_agents_where_it_is_defined():
    walks = [
        Walk(straight((0.0, 0.0), (0.0, 0.0)), (5.0, 0.0)),
        Walk(straight((0.0, 3.0), (1.0, 0.0)), (5.0, 3.0)),
    ]
    (row,) = measure(record(walks), [load_metric("time_to_goal")])
    assert row["value"] == pytest.approx(4.8)
    assert (row["agents"], row["defined"]) == (2, 1)
    (row,) = measure(record(walks[:1]), [load_metric("time_to_goal")])
    assert math.isnan(row["value"])
    assert row["defined"] == 0


def test_failure_of_the_navigator_is_told_and_charged():
    walk = Walk(straight((0.0, 0.0), (1.0, 0.0)), (5.0, 0.0))
    failed = replace(record([walk]), failure="ValueError: no")
    found = {r["metric"]: r for r in measure(failed, all_metrics())}
    assert found["success"]["value"] == found["arrival"]["value"] == 0.0
    assert found["spl"]["value"] == 0.0
    assert found["failed"]["value"] == 1.0
    assert math.isnan(found["time_to_goal"]["value"])
    assert found["success"]["failure"] == "ValueError: no"


def test_geodesic_is_computed_once_per_episode(monkeypatch):
    calls = []
    real = geodesic.geodesic_lengths

    def counted(*arguments):
        calls.append(1)
        return real(*arguments)

    monkeypatch.setattr(geodesic, "geodesic_lengths", counted)
    measure(smooth().episode(), [load_metric(n) for n in ("efficiency", "spl", "sct")])
    assert len(calls) == 1


def test_analysis_lives_as_long_as_its_episode():
    episode = smooth().episode()
    assert analyse(episode) is analyse(episode)
    kept = weakref.ref(analyse(episode))
    del episode
    gc.collect()
    assert kept() is None


def test_geodesic_is_undefined_where_walls_move():
    from benchnav.arena.body import Body, Law, LawKind
    from benchnav.arena.solid import Kind, Solid

    law = Law(LawKind.RELOCATE, np.array([0.0, 3.0]), np.array([[2.0, 4.0], [3.0, 4.0]]))
    setting = Setting(
        bodies=(Body(Solid(Kind.STATIC, radius=0.5), law),),
        body_paths=(lambda t: np.where(t[:, None] > 3.0, [[3.0, 4.0]], [[2.0, 4.0]]),),
    )
    episode = record([Walk(straight((0.0, 0.0), (1.0, 0.0)), (5.0, 0.0))], setting)
    for name in ("geodesic_length", "efficiency", "spl", "sct"):
        assert math.isnan(measure(episode, [load_metric(name)])[0]["value"])


def test_a_metric_that_raises_costs_its_own_value_and_says_why():
    def broken(episode):
        raise ZeroDivisionError("oh\nno")

    rows = measure(zoo()["smooth"], [_metric(broken), load_metric("success")])
    found = {(r["role"], r["metric"]): r for r in rows}
    for role in ("leader", "follower"):
        lost = found[role, "x"]
        assert math.isnan(lost["value"])
        assert lost["defined"] == 0
        assert re.fullmatch(
            r"ZeroDivisionError: oh no \(tests/metrics/test_measure.py:\d+\)", lost["missing"]
        )
        assert lost["traceback"].startswith('Traceback (most recent call last):\n  File "tests/')
        assert 'raise ZeroDivisionError("oh\\nno")' in lost["traceback"]
        assert (found[role, "success"]["missing"], found[role, "success"]["traceback"]) == (
            "",
            None,
        )
    assert found["leader", "success"]["value"] == 0.5
    (short,) = {r["missing"] for r in measure(zoo()["smooth"], [_metric(lambda e: np.zeros(1))])}
    assert short.startswith("IndexError: ")
    with pytest.raises(KeyboardInterrupt):
        measure(zoo()["smooth"], [_metric(_interrupted)])


def test_a_kernel_of_benchnav_that_does_not_compile_is_no_missing_value():
    @kernel
    def wrong(a):
        return a.no_such_attribute

    metric = replace(load_metric("success"), function=lambda e: wrong(1.0))
    with pytest.raises(numba.core.errors.TypingError):
        measure(zoo()["smooth"], [metric])


def _interrupted(episode):
    raise KeyboardInterrupt


def test_names_are_checked():
    with pytest.raises(PluginError, match=r"different names. Got x twice"):
        measure(zoo()["smooth"], [_metric(lambda e: e.arrival), _metric(lambda e: e.arrival)])
    with pytest.raises(PluginError, match=r"Metric, as the decorator .* Got the"):
        METRICS.register("tests_no_metric")(dict)
    with pytest.raises(PluginError, match=r"must carry that name, and not 'first_name'"):
        METRICS.register("tests_other_name")(_metric(lambda e: e.arrival, "first_name"))
    with pytest.raises(PluginError, match=r"must be a benchnav.metrics.metric.Metric, as the"):
        load_metric("benchnav.metrics.success:success_time")
    assert load_metric("benchnav.metrics.success:success").name == "success"
