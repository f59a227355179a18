import math
from dataclasses import replace

import numpy as np
import pytest
from benchnav_baselines.controllers.dwa.clearance import (
    CREEP,
    along_arc,
    arc_clearance,
    meeting_time,
)
from benchnav_baselines.controllers.dwa.controller import DynamicWindow
from benchnav_baselines.controllers.dwa.kernel import admissible, facing, window

from benchnav.arena.solid import Kind
from benchnav.geometry.capsule import nearest_on_segment
from benchnav.navigation.controller import Guide
from benchnav.sensors.readings import Edges, Neighbours
from tests.baselines.crowds import DT, briefing, joined, one_world

NOBODY = np.zeros((0, 2)), np.zeros(0), 0


def driven(x, y, heading, v, w, time, substeps=1):
    """Where the simulator's law of twists leads: chords along the heading amid each substep."""
    h = time / substeps
    for _ in range(substeps):
        x += v * h * math.cos(heading + 0.5 * w * h)
        y += v * h * math.sin(heading + 0.5 * w * h)
        heading += w * h
    return x, y, heading


def test_arcs_are_what_twists_drive():
    rng = np.random.default_rng(1)
    for _ in range(50):
        v, w, t, heading = rng.uniform(0.1, 2), rng.normal(0, 2), rng.uniform(0, 3), rng.normal()
        x, y, _ = driven(1.0, 2.0, heading, v, w, t, 4000)
        np.testing.assert_allclose(along_arc(1.0, 2.0, heading, v, w, v * t), (x, y), atol=1e-5)
    np.testing.assert_allclose(along_arc(0, 0, 0, 1, 1, math.pi / 2), (1, 1))  # a quarter circle


def gap_to(x, y, start, end):
    near = [nearest_on_segment(x, y, *a, *b) for a, b in zip(start, end, strict=True)]
    return min(math.hypot(px - x, py - y) for px, py in near)


def test_clearance_equals_a_walk_along_the_arc_in_small_steps():
    rng = np.random.default_rng(2)
    met = 0
    for _ in range(150):
        start, end = rng.uniform(-3, 3, (2, 3, 2))
        v, w, reach = rng.uniform(0.2, 2), rng.normal(0, 1), rng.uniform(0.1, 0.5)
        if gap_to(0, 0, start, end) < reach:
            continue
        got = arc_clearance(0, 0, 0, v, w, reach, start, end, 3, *NOBODY, 3.0)
        way = np.arange(0, 3.0, 0.002)
        gap = [gap_to(*along_arc(0, 0, 0, v, w, s), start, end) - reach for s in way]
        touching = way[np.array(gap) <= 0.0]
        grazing = way[np.array(gap) <= CREEP]
        first = touching[0] if len(touching) else 3.0
        assert got <= first + CREEP + 0.002
        assert got >= (grazing[0] if len(grazing) else 3.0) - 0.002
        met += bool(len(touching))
    assert met > 30


def test_neighbours_are_met_when_they_come():
    head_on = np.array([[4.0, 0.0]]), np.array([[-1.0, 0.0]]), np.array([0.5]), 1
    # 4 m apart, 1 m between centres at contact, closing at 2 m/s: after 1.5 s
    assert meeting_time(0, 0, 0, 1.0, 0.0, 0.5, *head_on, 3.0, 9.0) == pytest.approx(1.5)
    assert meeting_time(0, 0, 0, 0.0, 0.0, 0.5, *head_on, 3.5, 9.0) == pytest.approx(3.0)
    assert meeting_time(0, 0, 0, 0.0, 0.0, 0.5, *head_on, 2.0, 9.0) == 2.0
    assert (
        meeting_time(0, 0, math.pi, 1.0, 0.0, 0.5, *head_on, 3.0, 9.0) == 3.0
    )  # runs away as fast
    # a right angle within 1 s at pi/2 rad/s, then straight north for 4 m, up to a standing disc
    beyond = np.array([[2 / math.pi, 5.0 + 2 / math.pi]]), np.zeros((1, 2)), np.array([0.5]), 1
    assert meeting_time(0, 0, 0, 1.0, math.pi / 2, 0.5, *beyond, 9.0, 1.0) == pytest.approx(5.0)
    assert meeting_time(0, 0, 0, 1.0, math.pi / 2, 0.5, *beyond, 9.0, 9.0) == 9.0
    inside = np.array([[0.5, 0.0]]), np.zeros((1, 2)), np.array([0.5]), 1
    assert meeting_time(0, 0, 0, 1.0, 0.0, 0.5, *inside, 3.0, 9.0) == 0.0
    assert meeting_time(0, 0, math.pi, 1.0, 0.0, 0.5, *inside, 3.0, 9.0) == 3.0


def test_the_window_is_what_can_be_reached():
    out = np.empty(5)
    window(1.0, 0.4, 0.0, 1.2, out)
    np.testing.assert_allclose(out, [0.6, 0.75, 0.9, 1.05, 1.2])
    window(0.3, 0.5, -1.0, 1.0, out)
    np.testing.assert_allclose(out, [-0.2, 0.0, 0.3, 0.55, 0.8])  # 0.05 became 0: straight on


def test_admissible_is_what_stops_in_time():
    # 1 m/s for 0.2 s, then braking at 2 m/s² for 0.25 m
    assert admissible(1.0, 0.0, 0.45 + 1e-9, 2.0, 5.0, DT)
    assert not admissible(1.0, 0.0, 0.45 - 1e-9, 2.0, 5.0, DT)
    assert admissible(0.0, 9.0, 0.0, 2.0, 5.0, DT)
    assert not admissible(1.0, 6.0, 0.5, 2.0, 5.0, DT)  # could not stop turning: 6 > 2 · 0.5 · 5


def test_facing_is_judged_where_the_body_comes_to_rest():
    assert facing(0, 0, 0, 0.0, 0.0, 5.0, 0.0, 2.0, 5.0, DT) == pytest.approx(1.0)
    assert facing(0, 0, 0, 0.0, 0.0, -5.0, 0.0, 2.0, 5.0, DT) == pytest.approx(0.0)
    # turning at 2 rad/s it comes to rest after 0.4 + 0.4 rad; the target there is faced
    assert facing(0, 0, 0, 0.0, 2.0, math.cos(0.8), math.sin(0.8), 2.0, 5.0, DT) == pytest.approx(1)
    # driving at 1 m/s it comes to rest 0.45 m on, beside the target
    assert facing(0, 0, 0, 1.0, 0.0, 0.45, 1.0, 2.0, 5.0, DT) == pytest.approx(0.5)


def steer(seen, told, target, remaining=3.0, **parameters):
    controller = DynamicWindow(DynamicWindow.Config(**parameters))
    controller.reset(told, seen.rows)
    at = target.shape[:2]
    return controller.steer(seen, Guide(target, np.full(at, remaining), np.ones(at, bool)))


def alone(told, x, y, heading, speed, segments, neighbours=None):
    """What one agent sees between ``segments`` (E, 4), solid to the left."""
    _, seen = one_world(0, 1)
    start, end = segments[None, None, :, :2], segments[None, None, :, 2:]
    along = (end - start) / np.linalg.norm(end - start, axis=-1, keepdims=True)
    flags = np.ones(start.shape[:3], bool)
    edges = Edges(start, end, along, along, flags, flags, np.array([[len(segments)]]))
    velocity = speed * np.array([[[math.cos(heading), math.sin(heading)]]])
    return replace(
        seen, position=np.array([[[x, y]]]), heading=np.array([[heading]]), velocity=velocity,
        goal=told.goal[None], neighbours=neighbours, edges=edges,
    )  # fmt: skip


def walk(controller, told, segments, target, steps, heading=0.0):
    """(steps, 5) x, y, heading, v, w of one agent that starts at rest."""
    controller.reset([told], np.array([0]))
    x, y = told.start[0]
    v, rows = 0.0, []
    for _ in range(steps):
        seen = alone(told, x, y, heading, v, segments)
        at = np.array([[target]])
        far = np.hypot(*(at - seen.position)[0].T)[None]
        v, w = controller.steer(seen, Guide(at, far, np.ones((1, 1), bool)))[0, 0]
        x, y, heading = driven(x, y, heading, v, w, DT, 2)
        rows.append((x, y, heading, v, w))
    return np.array(rows)


def test_through_a_straight_corridor_it_drives_at_full_speed_and_changes_within_its_limits():
    told = briefing([(0.0, 0.2)], [(20.0, 0.0)], preferred=1.2)
    walls = np.array([(30.0, 0.9, -5.0, 0.9), (-5.0, -0.9, 30.0, -0.9)])
    controller = DynamicWindow(DynamicWindow.Config(acceleration=1.5, turn_acceleration=4.0))
    run = walk(controller, told, walls, (20.0, 0.0), 60)
    np.testing.assert_allclose(run[8:, 3], 1.2)
    assert np.abs(run[:, 1]).max() < 0.9 - 0.3
    assert np.abs(run[20:, 1]).max() < 0.25
    assert np.abs(np.diff(run[:, 3], prepend=0.0)).max() <= 1.5 * DT + 1e-9
    assert np.abs(np.diff(run[:, 4], prepend=0.0)).max() <= 4.0 * DT + 1e-9


@pytest.mark.parametrize("seed", range(8))
def test_among_what_stands_it_never_collides(seed):
    """Whatever the target and the weights, it can stop before what it sees."""
    rng = np.random.default_rng(seed)
    centre = rng.uniform(-4, 4, (12, 2))
    centre = centre[np.hypot(*centre.T) > 1.4]
    segments = np.concatenate([np.hstack([c - d, c + d]) for c in centre for d in _directions(rng)])
    told = briefing([(0.0, 0.0)], [(9.0, 9.0)], preferred=1.5, limit=2.0)
    weights = dict(zip(("heading", "distance", "speed"), rng.uniform(0, 1, 3), strict=True))
    config = DynamicWindow.Config(acceleration=rng.uniform(1, 5), turn_acceleration=10.0, **weights)
    run = walk(DynamicWindow(config), told, segments, rng.uniform(-5, 5, 2), 80)
    gaps = [gap_to(x, y, segments[:, :2], segments[:, 2:]) for x, y in run[:, :2]]
    assert min(gaps) > 0.3
    assert run[:, 3].max() > 0.3


def _directions(rng):
    angle = rng.uniform(0, 2 * math.pi)
    d = 0.5 * np.array([math.cos(angle), math.sin(angle)])
    return d[None], np.array([[-d[1], d[0]]])


def test_prediction_is_an_extension_that_can_be_switched_off():
    """One who crosses ahead is let pass where prediction is on; as in the paper it is not seen."""
    told = briefing([(0.0, 0.0)], [(20.0, 0.0)], preferred=1.0, radius=0.3)
    crossing = Neighbours(
        np.array([[[(1.6, -1.6)]]]), np.array([[[(0.0, 1.0)]]]), np.full((1, 1, 1), 0.5),
        np.full((1, 1, 1), int(Kind.DYNAMIC), np.int8), np.ones((1, 1), np.int64),
    )  # fmt: skip
    seen = alone(told, 0.0, 0.0, 0.0, 1.0, np.zeros((0, 4)), crossing)
    ahead = np.array([[(3.0, 0.0)]])
    seen_now = crossing.position[0, 0], crossing.velocity[0, 0], crossing.radius[0, 0], 1
    meets = {}
    for predict in (False, True):
        v, w = steer(seen, [told], ahead, predict=predict, distance=0.4, speed=0.8)[0, 0]
        meets[predict] = meeting_time(0, 0, 0, v, w, 0.3, *seen_now, 3.0, 0.6)
    assert meets[False] < 1.5
    assert meets[True] > 2.0


def test_batch_does_not_matter():
    told, seen = zip(*(one_world(w, 7) for w in range(3)), strict=True)
    target = np.random.default_rng(1).normal(0, 3, (3, 7, 2))
    together = steer(joined(seen), told, target)
    assert np.unique(together.round(6)).size > 10
    for w in range(3):
        alone_ = steer(seen[w], [told[w]], target[w : w + 1])
        np.testing.assert_array_equal(alone_[0], together[w])
