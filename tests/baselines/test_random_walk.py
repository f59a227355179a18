from dataclasses import replace

import numpy as np
import pytest
from benchnav_baselines.navigators.random_walk import RandomWalk

from tests.baselines.crowds import DT, answers, briefing, joined, keyed, one_world, permuted


def walk(navigator, told, seen, steps):
    """(steps, B, A, 2) commands."""
    navigator.reset(told, seen.rows)
    return np.stack([navigator.act(seen) for _ in range(steps)])


def test_speed_is_the_preferred_one_and_the_first_heading_is_near_the_start_heading():
    told, seen = one_world(0, 8)
    command = answers(RandomWalk(RandomWalk.Config(turning=0.01)), [told], seen)[0]
    np.testing.assert_allclose(np.hypot(*command.T), 1.0)
    heading = np.stack([np.cos(told.heading), np.sin(told.heading)], axis=-1)
    assert np.abs(command - heading).max() < 0.01


def test_without_turning_it_goes_straight():
    told, seen = one_world(0, 3)
    steps = walk(RandomWalk(RandomWalk.Config(turning=0)), [told], seen, 5)
    np.testing.assert_allclose(steps, np.broadcast_to(steps[0], steps.shape), atol=1e-14)


def test_the_heading_diffuses_as_configured():
    told, seen = one_world(0, 400, mover=0)
    turning, seconds = 0.3, 4.0
    steps = walk(RandomWalk(RandomWalk.Config(turning=turning)), [told], seen, int(seconds / DT))
    last = np.arctan2(steps[-1, 0, :, 1], steps[-1, 0, :, 0])
    turned = (last - told.heading + np.pi) % (2 * np.pi) - np.pi
    assert turned.std() == pytest.approx(turning * np.sqrt(seconds), rel=0.1)
    assert abs(turned.mean()) < 0.1


def test_batch_rows_and_numbering_do_not_matter():
    worlds = [one_world(w, 5) for w in range(3)]
    told, seen = zip(*worlds, strict=True)
    together = walk(RandomWalk(), told, joined(seen), 4)
    order = np.array([4, 2, 0, 1, 3])
    for w, (one, view) in enumerate(worlds):
        fresh = replace(one, rng=keyed(w))
        np.testing.assert_array_equal(walk(RandomWalk(), [fresh], view, 4)[:, 0], together[:, w])
        other, shuffled = permuted(replace(one, rng=keyed(w)), view, order)
        renumbered = walk(RandomWalk(), [other], shuffled, 4)
        np.testing.assert_array_equal(renumbered[:, 0], together[:, w, order])


def test_a_world_that_is_reset_starts_anew_and_others_go_on():
    worlds = [one_world(w, 2) for w in range(2)]
    told, seen = zip(*worlds, strict=True)
    both, navigator = joined(seen), RandomWalk()
    whole = walk(navigator, told, both, 4)
    again = RandomWalk()
    again.reset([replace(b, rng=keyed(w)) for w, b in enumerate(told)], both.rows)
    first = [again.act(both) for _ in range(2)]
    again.reset([replace(told[0], rng=keyed(0))], np.array([0]))
    after = again.act(both)
    np.testing.assert_array_equal(np.stack(first), whole[:2])
    np.testing.assert_array_equal(after[0], whole[0, 0])
    np.testing.assert_array_equal(after[1], whole[2, 1])


def test_padding_is_filled_and_nobody_is_fine():
    told = briefing(np.zeros((1, 2)), np.ones((1, 2)))
    _, seen = one_world(0, 3)
    assert np.all(answers(RandomWalk(), [told], seen)[0, 1:] == 0.0)
    nobody = briefing(np.zeros((0, 2)), np.zeros((0, 2)))
    assert np.all(answers(RandomWalk(), [nobody], seen) == 0.0)
