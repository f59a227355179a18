"""The world of a rehearsal is the scored one in all that stands, and not in what moves."""

from dataclasses import replace

import numpy as np
import pytest

from benchnav.arena.agents import Role
from benchnav.arena.body import Body, Law, LawKind
from benchnav.arena.solid import Kind
from benchnav.generation.rehearsal_world import leaders_of, rehearsal_world
from benchnav.navigation.tracks import granted_map
from tests import worlds


def rng(seed=0):
    return np.random.default_rng(seed)


def crew(role, team, start=None, driver=0):
    count = len(role)
    start = np.arange(2.0 * count).reshape(count, 2) + 1.0 if start is None else np.array(start)
    made = worlds.agents(start, start + 5.0, team=0, driver=driver)
    return replace(
        made, role=np.array(role, np.int8), team=np.array(team, np.int64),
        driver=np.broadcast_to(np.array(driver, np.int64), (count,)).copy(),
    )  # fmt: skip


LEADER, FOLLOWER = int(Role.LEADER), int(Role.FOLLOWER)


def test_leaders_lead_and_where_there_is_none_the_member_in_the_middle():
    start = [(1, 1), (2, 1), (9, 1), (9, 2), (9.2, 4), (9, 9)]
    agents = crew([LEADER, FOLLOWER, *[FOLLOWER] * 4], [0, 0, 1, 1, 1, 1], start)
    assert leaders_of(agents).tolist() == [0, 4]
    turned = np.array([5, 4, 3, 2, 1, 0])
    other = crew(agents.role[turned], agents.team[turned], np.array(start)[turned])
    assert leaders_of(other).tolist() == [1, 5]


def test_every_leader_of_a_team_leads_and_others_agents_do_not():
    agents = crew([LEADER, LEADER, LEADER], [0, 0, 1], driver=[0, 0, 2])
    assert leaders_of(agents).tolist() == [0, 1]
    world, index = rehearsal_world(worlds.world(agents), rng())
    assert index.tolist() == [0, 1, 2]
    assert world.agents.evaluated.tolist() == [True, True, False]


def bodies():
    mover = worlds.disc(Kind.DYNAMIC, 0.0, 0.0, 0.3)
    track = Law(
        LawKind.TRACK, np.array([0.0, 2.0, 4.0]), np.array([[8.0, 8], [9, 8], [8, 8]]), True
    )
    circle = Law(LawKind.CIRCLE, np.array([0.5]), np.array([[12.0, 12.0], [2.0, 0.7]]), True)
    recorded = Law(LawKind.TRACK, np.array([0.0, 9.0]), np.array([[3.0, 15.0], [9.0, 15.0]]))
    moved = Law(LawKind.RELOCATE, np.array([0.0, 5.0]), np.array([[15.0, 5.0], [5.0, 15.0]]))
    furniture = worlds.disc(Kind.STATIC, 0.0, 0.0, 0.4)
    return [Body(mover, track), Body(mover, circle), Body(mover, recorded), Body(furniture, moved)]


def test_phases_are_drawn_anew_and_nothing_else():
    scored = worlds.world(crew([LEADER], [0]), bodies=bodies())
    drawn = [rehearsal_world(scored, rng(k))[0] for k in range(200)]
    for world in drawn:
        track, circle, recorded = (body.law for body in world.bodies)
        assert 0.0 <= track.phase < 4.0
        assert np.array_equal(circle.points[0], [12.0, 12.0])
        assert circle.points[1, 0] == 2.0
        assert recorded.phase == 0.0
    phases = np.array([w.bodies[0].law.phase for w in drawn])
    angles = np.array([w.bodies[1].law.points[1, 1] for w in drawn])
    assert phases.mean() == pytest.approx(2.0, abs=0.3)
    assert angles.mean() == pytest.approx(np.pi, abs=0.5)
    assert scored.bodies[1].law.points[1, 1] == 0.7  # the scored world is not touched


@pytest.mark.parametrize("track", ["known", "stale"])
def test_what_is_re_placed_later_stands_where_it_begins(track):
    scored = worlds.world(crew([LEADER], [0]), [worlds.walls(20.0)], bodies())
    world, _ = rehearsal_world(scored, rng())
    assert not world.relocates
    assert world.solids[-1].center == (15.0, 5.0)
    before, now = granted_map(scored, track), granted_map(world, track)
    assert [s.capsules.tolist() for s in now.solids] == [s.capsules.tolist() for s in before.solids]
