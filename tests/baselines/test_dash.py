"""Agents that come no nearer to their goals, and those that come from behind."""

import math
from dataclasses import replace

import numpy as np
import pytest
from benchnav_baselines.learned.recurrent_ppo.dash import IMPATIENT, dash
from benchnav_baselines.learned.recurrent_ppo.progress import NEARER, Progress
from benchnav_baselines.learned.recurrent_ppo.sightings import (
    BEHIND,
    JAMMED,
    without_agents_behind,
)

from benchnav.arena.solid import Kind
from benchnav.envs.encoders.encoder import Bodies
from benchnav.navigation.navigator import Need
from benchnav.navigation.plugin.configure import make
from benchnav.plugins import NAVIGATORS
from benchnav.testing.observations import briefings_of, observations_of
from benchnav.testing.scenes import USUAL, scene
from tests.reference.dash import dash as slow_dash

SENSES = frozenset({Need.NEIGHBOURS, Need.EDGES})
HOLD = 0.9
LIMITS = ("radius", "max_speed", "max_turn_rate")


@pytest.fixture(scope="module")
def shown():
    """(briefings, observations with goals near the agents, bodies) in three worlds."""
    worlds = [replace(scene(k, 6), sensing=USUAL) for k in range(3)]
    told = briefings_of(worlds, SENSES)
    bodies = Bodies(*(np.array([getattr(one, name) for one in told]) for name in LIMITS))
    away = np.random.default_rng(0).uniform(-2.0, 2.0, (*bodies.radius.shape, 2))
    views = observations_of(worlds, SENSES, frames=20)
    return told, [replace(seen, goal=seen.position + away) for seen in views], bodies


def dashed(seen, bodies, tolerance, seconds):
    """The commands of agents that have come no nearer for some time."""
    command = np.full((*seen.active.shape, 2), -1.0)  # no twist of the lattice
    dash(seen, bodies, command, tolerance, HOLD, np.full(seen.active.shape, seconds))
    return command


def test_impatient_agents_dash_as_their_twin_does(shown):
    _, views, bodies = shown
    tolerance = np.full(views[0].active.shape, 0.5)
    dashes = others = 0
    for seen in views[::4]:
        assert (dashed(seen, bodies, tolerance, IMPATIENT) == -1.0).all()
        command = dashed(seen, bodies, tolerance, IMPATIENT + 0.1)
        for b, a in np.argwhere(seen.active):
            twist = slow_dash(seen, bodies, tolerance, b, a, HOLD)
            expected = (-1.0, -1.0) if twist is None else twist
            np.testing.assert_allclose(command[b, a], expected, atol=1e-9)
            dashes += twist is not None
            others += twist is None
        assert (command[~seen.active] == -1.0).all()
    assert dashes > 5
    assert others > 5
    waypoints = np.zeros(views[0].active.shape)
    assert (dashed(views[0], bodies, waypoints, IMPATIENT + 0.1) == -1.0).all()


def test_progress_is_counted_from_the_nearest_place_to_the_same_goal(shown):
    told, views, _ = shown
    seen, dt = views[0], told[0].dt
    way = seen.goal - seen.position
    ahead = way / np.linalg.norm(way, axis=-1, keepdims=True)
    progress = Progress()
    for row, one in enumerate(told):
        progress.reset(row, one)
    nearer = replace(seen, position=seen.position + 2.0 * NEARER * ahead)
    hardly = replace(nearer, position=nearer.position + 0.5 * NEARER * ahead)
    elsewhere = replace(seen, goal=seen.goal + 0.01)
    for view, expected in (
        (seen, 0), (seen, 1), (nearer, 0), (hardly, 1), (seen, 2), (nearer, 3), (elsewhere, 0),
    ):  # fmt: skip
        np.testing.assert_allclose(progress.stalled(view), expected * dt)
    progress.reset(1, told[1])
    np.testing.assert_allclose(progress.stalled(elsewhere)[:, 0], [dt, 0.0, dt])


def test_agents_behind_are_left_out_unless_progress_has_stopped(shown):
    left_out = 0
    for seen in shown[1]:
        stalled = np.where(np.arange(seen.active.shape[1]) % 3, JAMMED, JAMMED + 0.1)
        stalled = np.broadcast_to(stalled, seen.active.shape)
        found, near = without_agents_behind(seen, stalled).neighbours, seen.neighbours
        for b, a in np.argwhere(seen.active):
            kept = []
            for n in range(near.count[b, a]):
                away = near.position[b, a, n] - seen.position[b, a]
                bearing = math.atan2(away[1], away[0]) - seen.heading[b, a]
                ahead = math.cos(bearing) >= BEHIND
                if ahead or near.kind[b, a, n] != Kind.AGENT or stalled[b, a] > JAMMED:
                    kept.append(n)
            assert found.count[b, a] == len(kept)
            for name in ("position", "velocity", "radius", "kind"):
                mine, theirs = getattr(found, name)[b, a], getattr(near, name)[b, a]
                np.testing.assert_array_equal(mine[: len(kept)], theirs[kept])
            left_out += near.count[b, a] - len(kept)
    assert left_out > 5


@pytest.mark.parametrize(("name", "ignores"), [("plus", True), ("vo", False)])
def test_only_a_policy_that_views_all_round_ignores_agents_behind_it(name, ignores, monkeypatch):
    from benchnav_baselines.learned.recurrent_ppo import policy_at_work

    shown_to, real = [], policy_at_work.foresee

    def spy(seen, *rest):
        shown_to.append(seen.neighbours.count.sum())
        return real(seen, *rest)

    counts = []
    for rule in (policy_at_work.without_agents_behind, lambda seen, _: seen):
        monkeypatch.setattr(policy_at_work, "without_agents_behind", rule)
        monkeypatch.setattr(policy_at_work, "foresee", spy)
        shown_to.clear()
        driver = make(NAVIGATORS, f"recurrent-ppo-{name}")
        worlds = [replace(scene(k, 6), sensing=USUAL) for k in range(3)]
        driver.reset(briefings_of(worlds, SENSES | {Need.RAYS}), np.arange(3))
        for seen in observations_of(worlds, SENSES | {Need.RAYS}, frames=20):
            driver.act(seen)
        counts.append(sum(shown_to))
    assert (counts[0] < counts[1]) == ignores
