"""Frames of films: what stands where, trails, contacts, and several episodes in step."""

import sys

import numpy as np
import pytest

import benchnav
from benchnav.arena.solid import Kind
from benchnav.drawing.canvas import Canvas, channels
from benchnav.drawing.palette import FILL, HIT, TEAMS
from benchnav.drawing.top_view import TopView
from benchnav.episode.episode import Status
from benchnav.viewer.episode_film import film

HEAD = 24  # [pixels] of text


@pytest.fixture(scope="module")
def episode():
    """Three agents touch something and vanish, and obstacles move."""
    drawn = benchnav.load_scenario("leaders/dynamic").world(seed=7)
    return benchnav.simulate(drawn, "straight-line", track="unknown").record


def near(picture, color, tolerance=24):
    return (np.abs(picture.astype(int) - np.array(channels(color))) < tolerance).all(axis=-1)


def at(episode, picture, place):
    """The pixels (3, 3, 3) around a place [m] of a picture of one episode."""
    x0, y0, x1, y1 = episode.world.bounds
    rim = 0.015 * max(x1 - x0, y1 - y0)
    scale = picture.shape[1] / (x1 - x0 + 2 * rim)
    x, y = int((place[0] - x0 + rim) * scale), HEAD + int((y1 + rim - place[1]) * scale)
    return picture[y - 1 : y + 2, x - 1 : x + 2]


def test_agents_and_obstacles_are_where_they_were(episode):
    state = 8
    (picture,) = film([episode], [episode.times[state]])
    for a in np.flatnonzero(episode.status[state] == int(Status.ACTIVE)):
        heading, radius = episode.heading[state, a], episode.world.agents.radius[a]
        behind = episode.position[state, a] - 0.5 * radius * np.array(
            [np.cos(heading), np.sin(heading)]
        )
        assert near(at(episode, picture, behind), TEAMS[a]).any()
    for body, place in zip(episode.world.bodies, episode.body_position[state], strict=True):
        assert near(at(episode, picture, place), FILL[Kind(body.solid.kind)]).all()


def test_a_contact_flashes_where_it_is(episode):
    first = int(np.argmin(episode.contacts.start))
    start, agent = float(episode.contacts.start[first]), int(episode.contacts.agent[first])
    state = int(np.ceil(start / episode.world.clock.dt))
    before, then, after = film([episode], [start - 0.2, episode.times[state], start + 20.0])
    x0, y0, x1, _ = episode.world.bounds
    rows, columns = np.nonzero(near(then, HIT, 60))
    scale = then.shape[1] / ((x1 - x0) * 1.03)
    radius = float(episode.world.agents.radius[agent])
    x, y = (episode.position[state, agent] - (x0, y0)) * scale
    apart = np.hypot(columns - x, then.shape[0] - rows - y)
    assert len(apart)
    assert apart.min() < 2.5 * radius * scale
    assert not near(before, HIT, 60).any()
    assert not near(after, HIT, 60).any()


def test_motion_between_states_is_linear(episode):
    """Halfway between two states, agents are halfway."""
    (picture,) = film([episode], [episode.times[3] + 0.5 * episode.world.clock.dt])
    for a in np.flatnonzero(episode.status[4] == int(Status.ACTIVE)):
        heading, radius = episode.heading[3, a], episode.world.agents.radius[a]
        middle = 0.5 * (episode.position[3, a] + episode.position[4, a])
        behind = middle - 0.5 * radius * np.array([np.cos(heading), np.sin(heading)])
        assert near(at(episode, picture, behind), TEAMS[a]).any()


def test_a_large_film_has_twice_the_size_and_a_note_is_seen(episode):
    (small,), (large,) = film([episode], [1.0]), film([episode], [1.0], large=True)
    assert large.shape == (2 * small.shape[0], 2 * small.shape[1], 3)
    (noted,) = film([episode], [1.0], note=", 2x")
    assert (noted[:HEAD] != small[:HEAD]).any()
    assert (noted[HEAD:] == small[HEAD:]).all()


def test_frames_do_not_depend_on_the_frames_before(episode):
    """Trails are drawn piece by piece: only their shade may differ a little."""
    (once,) = film([episode], [4.0])
    *_, last = film([episode], [0.2 * n for n in range(21)])
    assert (np.abs(once.astype(int) - last) > 110).any(axis=-1).mean() < 0.002


def test_films_need_no_plotting_library(episode, monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    frames = list(film([episode] * 5, [0.0, 99.0]))  # two rows of three
    high, wide, _ = next(film([episode], [0.0])).shape
    one = (high, wide + 6)  # with paper at the sides
    assert [frame.shape for frame in frames] == [(2 * one[0], 3 * one[1], 3)] * 2
    assert (frames[0][: one[0], : one[1]] == frames[0][one[0] :, : one[1]]).all()
    assert (frames[0][one[0] :, 2 * one[1] :] == 255).all()


def test_a_path_that_runs_back_over_itself_stays_dotted():
    shuttle = np.array([[0.0, 5.0], [10.0, 5.0]] * 20)
    canvas = Canvas((0.0, 0.0, 10.0, 10.0), 100)
    canvas.dots(shuttle, "#000000", apart=4.0)
    dark = (canvas.array() < 128).all(axis=-1).any(axis=0)
    assert 20 <= dark.sum() <= 60


def test_a_cross_stands_out_on_a_disc(episode):
    view = TopView(episode.world, 200)
    canvas = view.background
    canvas.disc(np.array([10.0, 10.0]), 1.0, fill=TEAMS[0])
    before = canvas.array()
    canvas.cross(np.array([10.0, 10.0]), TEAMS[0])
    assert (canvas.array() != before).any()
