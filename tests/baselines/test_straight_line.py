from dataclasses import replace

import numpy as np
from benchnav_baselines.common.approach import approach
from benchnav_baselines.navigators.straight_line import StraightLine
from hypothesis import given
from hypothesis import strategies as st

from tests.baselines.crowds import DT, answers, briefing, joined, one_world, permuted

number = st.floats(-50, 50).map(lambda x: round(x, 3))


@given(number, number, number, number, st.floats(0.1, 3.0))
def test_approach_points_at_the_target_and_never_passes_it(px, py, tx, ty, speed):
    position, target = np.array([px, py]), np.array([tx, ty])
    velocity = approach(position, target, np.array(speed), np.array(DT))
    offset = target - position
    distance = np.hypot(*offset)
    assert np.hypot(*velocity) <= min(speed, distance / DT) * (1 + 1e-12)
    np.testing.assert_allclose(velocity * distance, offset * np.hypot(*velocity), atol=1e-9)
    if distance <= speed * DT:
        np.testing.assert_allclose(position + DT * velocity, target, atol=1e-9)


def test_it_drives_straight_at_its_goal_at_preferred_speed():
    told = briefing([(0, 0), (1, 1)], [(3, 4), (1, 1)], preferred=1.2)
    _, seen = one_world(0, 2)
    seen = replace(seen, position=told.start[None], goal=told.goal[None])
    command = answers(StraightLine(), [told], seen)
    np.testing.assert_allclose(command, [[(0.72, 0.96), (0, 0)]])


def test_batch_and_numbering_do_not_matter():
    worlds = [one_world(w, 5) for w in range(3)]
    told, seen = zip(*worlds, strict=True)
    together = answers(StraightLine(), told, joined(seen))
    order = np.array([4, 2, 0, 1, 3])
    for w, (one, view) in enumerate(worlds):
        np.testing.assert_array_equal(answers(StraightLine(), [one], view)[0], together[w])
        other, shuffled = permuted(one, view, order)
        np.testing.assert_array_equal(
            answers(StraightLine(), [other], shuffled)[0], together[w, order]
        )
