"""Outcomes of attempts, and the names of the things that were hit, from hand-made episodes."""

from dataclasses import replace

import numpy as np
import pytest

from benchnav.arena.agents import Role
from benchnav.arena.body import still
from benchnav.arena.solid import Kind
from benchnav.metrics.success import success
from benchnav.report.analysis.episode_summary import summarise
from benchnav.report.analysis.outcome import NO_CONTACT, Outcome, outcomes
from benchnav.report.analysis.partner import fixed_obstacles, partner_name, without_number
from benchnav.testing.episodes import Hit, Setting, Walk, box, record, room, straight
from tests.worlds import back_and_forth, disc

GOAL = (5.0, 0.0)
GOES, STANDS = straight((0.0, 0.0), (1.0, 0.0)), straight((0.0, 0.0), (0.0, 0.0))
CIRCLES = straight((0.0, 9.0), (0.4, 0.0))  # moves until the horizon, far from its goal


def _outcome(walk, **setting):
    found, cause = outcomes(record([walk], Setting(**setting)))
    return Outcome(found[0]), int(cause[0])


@pytest.mark.parametrize(
    ("kind", "partner", "outcome"),
    [
        (Kind.AGENT, 1, Outcome.HIT_AGENT),
        (Kind.WALL, 0, Outcome.HIT_WALL),
        (Kind.STATIC, 0, Outcome.HIT_STATIC),
        (Kind.DYNAMIC, -1, Outcome.HIT_DYNAMIC),
    ],
)
def test_a_charged_contact_before_arrival_is_a_collision(kind, partner, outcome):
    walk = Walk(GOES, GOAL, hits=(Hit(1.0, kind=kind, partner=partner),))
    assert _outcome(walk) == (outcome, 0)


def test_only_the_first_charged_contact_counts():
    hits = (Hit(0.5, charged=False), Hit(1.0, kind=Kind.STATIC), Hit(2.0, kind=Kind.WALL))
    assert _outcome(Walk(GOES, GOAL, hits=hits)) == (Outcome.HIT_STATIC, 1)


def test_a_contact_after_arrival_is_no_failure():
    assert _outcome(Walk(GOES, GOAL, hits=(Hit(9.0),))) == (Outcome.SUCCESS, NO_CONTACT)


def test_timeouts_are_stuck_or_on_their_way():
    assert _outcome(Walk(STANDS, GOAL)) == (Outcome.STUCK, NO_CONTACT)
    assert _outcome(Walk(CIRCLES, GOAL)) == (Outcome.TIMEOUT, NO_CONTACT)


def test_a_collision_counts_before_a_timeout():
    assert _outcome(Walk(STANDS, GOAL, hits=(Hit(1.0),))) == (Outcome.HIT_WALL, 0)


def test_a_failed_navigator_and_an_end_without_a_charge():
    hits = (Hit(1.0),)
    assert _outcome(Walk(GOES, GOAL, hits=hits), failure="ValueError") == (
        Outcome.NAVIGATOR_FAILED, NO_CONTACT,
    )  # fmt: skip
    ended = Walk(GOES, GOAL, ends=2.0, hits=(Hit(2.0, charged=False),))
    assert _outcome(ended) == (Outcome.OTHER, NO_CONTACT)


def _crowd():
    """Leaders that arrive, hit a wall and stand; a follower that hits the outer wall."""
    walks = [
        Walk(straight((0.0, 3.0 * n), (1.0, 0.0)), (5.0, 3.0 * n), hits=hits)
        for n, hits in enumerate([(), (Hit(1.25, partner=1),), (Hit(3.0, partner=1),)])
    ]
    walks.append(Walk(STANDS, (5.0, 9.0)))
    walks.append(Walk(GOES, GOAL, role=Role.FOLLOWER, team=1, hits=(Hit(1.0, partner=0),)))
    walks.append(Walk(GOES, GOAL, driver=1, hits=(Hit(1.0),)))
    solids = (room((-20.0, -20.0, 20.0, 20.0)), box((3.0, 3.0), 1.0, 1.0, Kind.WALL))
    return record(walks, Setting(solids=solids))


def test_a_summary_has_the_shares_of_each_role_and_no_background_agents():
    episode = _crowd()
    found = summarise(episode, ("known", "unknown"))
    shares = dict(found.shares)
    assert shares["leader"] == pytest.approx((0.25, 0, 0.25, 0, 0, 0, 0.5, 0, 0))
    assert shares["follower"] == pytest.approx((0, 0, 0, 0, 0, 0, 1, 0, 0))
    leaders = episode.world.agents.evaluated & (episode.world.agents.role == Role.LEADER)
    assert shares["leader"][Outcome.SUCCESS] == success(episode)[leaders].mean()
    assert [(c.agent, c.role, c.partner) for c in found.collisions] == [
        (1, "leader", "wall 1"), (2, "leader", "wall 1"), (4, "follower", "outer wall"),
    ]  # fmt: skip
    assert found.collisions[0].time == 1.25
    assert found.collisions[0].place == pytest.approx((1.25, 3.0))
    assert found.tracks == ("known", "unknown")
    assert [(a.role, len(a.times)) for a in found.attempts] == [("leader", 4), ("follower", 1)]


def _world(*solids, bodies=()):
    walks = [Walk(STANDS, GOAL), Walk(STANDS, GOAL, team=1), Walk(STANDS, GOAL, team=1, driver=1)]
    solids = (room((-9.0, -9.0, 9.0, 9.0)), *solids)
    world = record(walks, Setting(solids=solids)).world
    return replace(world, bodies=tuple(bodies))


def test_names_of_partners():
    mover = back_and_forth(disc(Kind.DYNAMIC, 0, 0, 0.5), (0, 0), (1, 0), 1.0)
    world = _world(
        box((1, 1), 1, 1, Kind.WALL), box((3, 3), 1, 1), box((5, 5), 1, 1), bodies=[mover]
    )
    assert [partner_name(world, Kind.WALL, k) for k in (0, 1)] == ["outer wall", "wall 1"]
    assert [partner_name(world, Kind.STATIC, k) for k in (2, 3)] == [
        "static obstacle 1", "static obstacle 2",
    ]  # fmt: skip
    assert partner_name(world, Kind.DYNAMIC, -1) == "moving obstacle 1"
    assert [partner_name(world, Kind.AGENT, k) for k in range(3)] == [
        "leader of team team 0", "leader of team team 1", "background agent of team team 1",
    ]  # fmt: skip


def test_obstacles_that_differ_between_worlds_have_no_number():
    mover = back_and_forth(disc(Kind.DYNAMIC, 0, 0, 0.5), (0, 0), (1, 0), 1.0)
    other = replace(mover, law=still(np.array([2.0, 0.0])))
    one = _world(box((1, 1), 1, 1, Kind.WALL), box((3, 3), 1, 1), bodies=[mover])
    two = _world(box((1, 1), 1, 1, Kind.WALL), box((4, 3), 1, 1), bodies=[other])
    assert fixed_obstacles([one, two]) == {"outer wall", "wall 1"}
    assert fixed_obstacles([one, one]) == {
        "outer wall", "wall 1", "static obstacle 1", "moving obstacle 1",
    }  # fmt: skip
    assert without_number("static obstacle 12") == "a static obstacle"
    assert without_number("outer wall") == "outer wall"
