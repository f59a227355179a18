"""A track grants what it names, and nothing more."""

import numpy as np
import pytest

from benchnav.arena.agents import Agents
from benchnav.arena.body import Body, Law, LawKind, still
from benchnav.arena.sensing import Sensing
from benchnav.arena.solid import Kind, Solid
from benchnav.arena.world import Afterwards, Charge, Clock, ContactRule, Rules, World
from benchnav.navigation.tracks import granted_map
from benchnav.scenario.terms import TRACKS


def make_world(stale=None):
    wall = Solid(Kind.WALL, (np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]),))
    cube = Solid(Kind.STATIC, (), (3.0, 3.0), 0.5)
    moved = Law(LawKind.RELOCATE, np.array([0.0, 4.0]), np.array([[1.0, 1.0], [2.0, 2.0]]))
    one, byte = np.ones(1), np.zeros(1, np.int8)
    return World(
        bounds=(0.0, 0.0, 9.0, 9.0),
        solids=(wall, cube),
        bodies=(
            Body(Solid(Kind.DYNAMIC, (), (0.0, 0.0), 0.3), still(np.array([5.0, 5.0]))),
            Body(Solid(Kind.STATIC, (), (0.0, 0.0), 0.25), moved),
        ),
        agents=Agents(
            np.zeros((1, 2)), one, np.zeros((1, 2)), one, one, one, one, byte, byte,
            np.zeros(1, int), np.zeros(1, int),
        ),
        teams=("t",),
        sees=np.ones((1, 1), bool),
        clock=Clock(0.1, 1, 100),
        rules=Rules(0.1, ContactRule.SLIDE, Afterwards.STAY, Afterwards.STAY, Charge.HITTER),
        sensing=Sensing(None, None, None),
        stale_solids=stale,
    )  # fmt: skip


def discs(granted):
    return [solid.center for solid in granted.solids if solid.is_disc]


def test_unknown_is_no_map():
    assert granted_map(make_world(), "unknown") is None


def test_partial_is_walls_alone():
    granted = granted_map(make_world(), "partial")
    assert [solid.kind for solid in granted.solids] == [Kind.WALL]


def test_known_follows_what_is_re_placed_and_counts_it():
    world = make_world()
    before = granted_map(world, "known")
    now = np.array([[6.0, 6.0], [2.0, 2.0]])
    after = granted_map(world, "known", now, revision=1)
    assert discs(before) == [(3.0, 3.0), (1.0, 1.0)]
    assert discs(after) == [(3.0, 3.0), (2.0, 2.0)]
    assert (before.revision, after.revision) == (0, 1)


def test_stale_is_how_things_stood_and_is_never_corrected():
    world = make_world(stale=(Solid(Kind.STATIC, (), (7.0, 7.0), 0.5),))
    now = np.array([[6.0, 6.0], [2.0, 2.0]])
    granted = granted_map(world, "stale", now, revision=1)
    assert discs(granted) == [(7.0, 7.0), (1.0, 1.0)]
    assert granted.revision == 0


@pytest.mark.parametrize("track", TRACKS)
def test_dynamic_obstacles_are_on_no_map(track):
    granted = granted_map(make_world(), track)
    assert granted is None or all(solid.kind != Kind.DYNAMIC for solid in granted.solids)


def test_who_is_granted_a_map_cannot_move_the_walls_with_it():
    granted = granted_map(make_world(), "known")
    with pytest.raises(ValueError, match="read-only"):
        granted.solids[0].loops[0][0, 0] = 5.0
    with pytest.raises(ValueError, match="read-only"):
        granted.solids[0].capsules[0, 0] = 5.0
