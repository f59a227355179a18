"""Every registered metric passes what outsiders must pass, and bad metrics do not."""

import math

import numpy as np
import pytest

from benchnav.metrics.measure import load_metric
from benchnav.metrics.metric import Metric, metric
from benchnav.metrics.quantities.episode_analysis import analyse
from benchnav.plugins import METRICS
from benchnav.testing.check_metric import CHECKS, check_metric, values
from benchnav.testing.zoo import zoo

SHIPPED = [
    "success",
    "arrival",
    "timeout",
    "stuck",
    "failed",
    "collided",
    "collisions_wall",
    "collisions_static",
    "collisions_dynamic",
    "collisions_agent",
    "contact_time",
    "min_clearance",
    "min_time_to_collision",
    "personal_space_intimate",
    "personal_space_personal",
    "time_to_goal",
    "path_length",
    "geodesic_length",
    "efficiency",
    "spl",
    "sct",
    "makespan",
    "turning",
    "log_dimensionless_jerk",
    "sparc",
    "jam",
    "density_mean",
    "density_peak",
    "flow",
    "congestion_level",
    "velocity_fluctuation",
    "cohesion",
    "polarisation",
    "splits",
    "path_keeping",
    "catch_up_time",
    "intrusion",
    "avoidance",
    "personal_space_approach",
    "collisions_people",
    "collisions_at_fault",
    "people_delay",
    "people_detour",
    "decision_time_p50",
    "decision_time_p95",
    "decision_time_p99",
    "latency_p50",
    "latency_p95",
    "latency_p99",
    "peak_memory",
    "planning_time",
    "over_budget",
]


def test_what_ships_is_registered():
    assert set(SHIPPED) <= set(METRICS.names())


@pytest.mark.parametrize("name", METRICS.names())
def test_registered_metric_conforms(name):
    check_metric(load_metric(name))


def _metric(function, better="higher", low=-math.inf, high=math.inf, **flags):
    return Metric(
        name="bad", title="A bad metric", unit="", better=better, low=low, high=high,
        reference="nowhere", function=function, **flags,
    )  # fmt: skip


def _steps(episode):
    return np.diff(episode.position, axis=0)


def _path_irregularity_about_the_origin(episode):
    """Angle between the motion and the direction from the origin: depends on where that is."""
    motion, place = _steps(episode), episode.position[:-1]
    angle = np.arctan2(motion[..., 1], motion[..., 0]) - np.arctan2(place[..., 1], place[..., 0])
    return np.abs(angle).mean(axis=0)


def _jerk_without_dt(episode):
    return (np.diff(episode.position, n=3, axis=0) ** 2).sum(axis=(0, 2))


def _energy_without_dt(episode):
    return (_steps(episode) ** 2).sum(axis=(0, 2))


def _path_with_yaw(episode):
    """Length in (x, y, direction): an angle added into metres, at every sample."""
    motion = _steps(episode)
    yaw = np.arctan2(motion[..., 1], motion[..., 0])[..., None]
    return np.sqrt((np.concatenate([motion, yaw], axis=2) ** 2).sum(axis=2)).sum(axis=0)


def _efficiency_of_standing(episode):
    """Net displacement over path length, 1 where there is no path."""
    path = np.hypot(*_steps(episode).transpose(2, 0, 1)).sum(axis=0)
    net = np.hypot(*(episode.position[-1] - episode.position[0]).T)
    return np.where(path > 0.0, net / np.where(path > 0.0, path, 1.0), 1.0)


def _goal_reached_when_it_stops(episode):
    """Reached whenever it is over, wherever that is: it never looks at the goal."""
    return (episode.status[-1] != 0).astype(float)


def _time_of_whoever_finished(episode):
    """Time until it is over, crashes included: quick to crash is quick."""
    return (episode.status == 0).sum(axis=0) * episode.world.clock.dt


def _seconds_near_others(episode):
    """Time within 1.2 m of another agent: a crash into a wall puts an end to it."""
    gap = analyse(episode).encounters.gap[:, :-1] < 1.2
    return (gap * analyse(episode).trajectories.duration).sum(axis=1)


def _mean_speed_of_the_record(episode):
    """Over the whole record, so that it falls while others are still walking."""
    length = np.hypot(*_steps(episode).transpose(2, 0, 1)).sum(axis=0)
    return length / (len(_steps(episode)) * episode.world.clock.dt)


def _steps_taken(episode):
    return (episode.status == 0).sum(axis=0).astype(float)


CALLS = iter(range(10**9))

BAD = {
    "origin": (_metric(_path_irregularity_about_the_origin), "turned by 0.00 rad and moved"),
    "frame": (
        _metric(lambda e: np.ptp(e.position[:, :, 0], axis=0)), "turned by 1.57 rad",
    ),
    "jerk without dt": (_metric(_jerk_without_dt, "lower"), "recorded with dt/2"),
    "energy without dt": (_metric(_energy_without_dt, "lower"), "recorded with dt/2"),
    "decisions for seconds": (_metric(_steps_taken, "lower"), "recorded with dt/2"),
    "yaw in length": (_metric(_path_with_yaw, "lower"), "must not change"),
    "perfect standing": (
        _metric(_efficiency_of_standing, low=0.0, high=1.0), "gets nowhere",
    ),
    "no goal": (
        _metric(_goal_reached_when_it_stops, low=0.0, high=1.0, rate=True), "gets nowhere",
    ),
    "turning of standing": (
        _metric(lambda e: 0.0 * e.arrival.size + np.zeros(len(e.arrival)), "lower", 0.0),
        "must not be perfect",
    ),
    "seconds near others": (
        _metric(_seconds_near_others, "lower", 0.0), "must not be perfect .* crashes at once",
    ),
    "seconds on the way": (
        _metric(_time_of_whoever_finished, "lower", 0.0), "crashes half-way",
    ),
    "whoever finished": (
        _metric(_time_of_whoever_finished, "lower", 0.0, conditional=True), "did not arrive",
    ),
    "after its end": (_metric(_mean_speed_of_the_record), "in a longer record"),
    "order": (
        _metric(lambda e: np.arange(len(e.arrival), dtype=float)), "agents in another order",
    ),
    "order of a group": (
        _metric(lambda e, m: float(e.position[0, 0, 0] - e.position[0, -1, 0]) ** 2, scope="group"),
        "must not change",
    ),
    "name": (
        _metric(lambda e: np.full(len(e.arrival), float(len(e.identity.navigator)))),
        "under another name",
    ),
    "timings": (
        _metric(lambda e: np.full(len(e.arrival), float(e.timings.planning))), "other timings",
    ),
    "mood": (_metric(lambda e: np.full(len(e.arrival), float(next(CALLS)))), "twice"),
    "range": (_metric(lambda e: e.arrival, low=0.0, high=1.0), "must be within"),
    "infinite": (
        _metric(lambda e: np.where(np.isnan(e.arrival), np.inf, e.arrival)), "must be NaN where",
    ),
    "shares for a rate": (
        _metric(lambda e: np.full(len(e.arrival), 0.5), low=0.0, high=1.0, rate=True), "is a rate",
    ),
    "shape": (_metric(lambda e: np.zeros(len(e.arrival) + 1)), "one value per agent"),
    "list": (_metric(lambda e: [0.0] * len(e.arrival)), "must return an array"),
    "writes": (_metric(lambda e: e.position.__imul__(2.0)[0, :, 0]), "read-only"),
    "empty range": (_metric(lambda e: e.arrival, low=1.0, high=0.0), "low must be below high"),
}  # fmt: skip


@pytest.mark.parametrize("mistake", BAD)
def test_bad_metric_is_caught(mistake):
    bad, said = BAD[mistake]
    with pytest.raises((AssertionError, ValueError), match=said):
        check_metric(bad)


def test_nothing_that_ranks_is_best_in_a_crash():
    """The reviewer's case: what ends early adds up to less, and is no achievement."""
    unranked = [name for name in SHIPPED if name.startswith(("collisions_", "personal_space_"))]
    unranked += ["jam", "timeout", "stuck", "failed", "intrusion", "avoidance"]
    unranked += ["people_delay", "people_detour"]
    assert {name for name in unranked if load_metric(name).better is not None} == set()
    crash = zoo()["crashing"]
    for name in SHIPPED:
        m = load_metric(name)
        if m.better == "lower" and m.verifiable:
            value = values(m, crash)[0]
            assert math.isnan(value) or value > m.low, name


def test_contact_takes_no_time_where_it_ends_the_attempt():
    assert np.isnan(values(load_metric("contact_time"), zoo()["crashing"])).all()
    assert values(load_metric("contact_time"), zoo()["idle"])[0] == pytest.approx(2.0)


def test_good_outside_metric_passes():
    """Mean speed until it is over, for whoever moves at all: what an outsider would write."""

    @metric(title="Mean speed", unit="m/s", better=None, low=0.0, reference="here")
    def mean_speed(episode):
        over = episode.status != 0
        last = np.where(over.any(axis=0), over.argmax(axis=0), len(over) - 1)
        way = np.cumsum(np.hypot(*np.diff(episode.position, axis=0).transpose(2, 0, 1)), axis=0)
        length = way[np.maximum(last, 1) - 1, np.arange(len(last))]
        time = np.where(np.isnan(episode.arrival), last * episode.world.clock.dt, episode.arrival)
        return np.where(time > 0.0, length / np.where(time > 0.0, time, 1.0), np.nan)

    assert len(CHECKS) == 11
    check_metric(mean_speed)
