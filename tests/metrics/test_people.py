"""Metrics of people: numbers against a slow twin and PedPy, faults against the simulator."""

import math
from dataclasses import replace

import numpy as np
import pandas as pd
import pedpy
import pytest

from benchnav.arena.body import Body, Law, LawKind
from benchnav.arena.solid import Kind
from benchnav.episode.episode import Identity
from benchnav.metrics.measure import load_metric, measure
from benchnav.metrics.people import collisions_at_fault, collisions_people
from benchnav.metrics.quantities.episode_analysis import analyse
from benchnav.metrics.quantities.fault import own_approach
from benchnav.metrics.quantities.people import RATE, approaches, tracks
from benchnav.runner.execute.measurement import failed_metrics, measured
from benchnav.runner.rollouts.recorder import Recorder
from benchnav.testing.check_metric import values
from benchnav.testing.episodes import Setting, Walk, record, straight
from benchnav.world.simulation import Simulation
from tests.reference import people as slow
from tests.runner.verify.faulty import play
from tests.worlds import agents, disc, random_world, world

NAMES = [
    "intrusion", "avoidance", "personal_space_approach", "collisions_people",
    "collisions_at_fault",
]  # fmt: skip
FRAMES, CROWD = 40, 7


def _crowd(seed):
    """Places (N, F, 2) and presence (N, F) of people who walk at random, early or late."""
    rng = np.random.default_rng(seed)
    walk = np.cumsum(rng.normal(0.0, 0.15, (CROWD, FRAMES, 2)), axis=1)
    first, last = rng.integers(0, 15, CROWD), rng.integers(25, FRAMES, CROWD)
    each = np.arange(FRAMES)
    there = (each >= first[:, None]) & (each <= last[:, None])
    return rng.uniform(-2.5, 2.5, (CROWD, 1, 2)) + walk, there


def _numbers(place, there, i, radius, preferred=1.0):
    """The numbers of walker i among all others."""
    others = np.arange(CROWD) != i
    agent = tracks(place[i : i + 1], there[i : i + 1], radius[i : i + 1])
    crowd = tracks(place[others], there[others], radius[others])
    return approaches(agent, crowd, np.array([preferred]))


@pytest.mark.parametrize("seed", range(3))
def test_numbers_agree_with_their_slow_twin(seed):
    place, there = _crowd(seed)
    radius = np.random.default_rng(seed).uniform(0.1, 0.4, CROWD)
    for i in range(CROWD):
        found = _numbers(place, there, i, radius, 1.3)
        others = [(place[j], there[j], radius[j]) for j in range(CROWD) if j != i]
        agent = place[i], there[i], radius[i], 1.3
        expected = np.array([slow.numbers(agent, others, f) for f in range(FRAMES)])
        np.testing.assert_allclose(np.concatenate(found[1:]).T, expected, rtol=1e-9, atol=1e-12)
        assert found.frames == there[i].sum()


@pytest.mark.skipif(
    not hasattr(pedpy, "compute_intrusion"),
    reason="this release of PedPy does not have the dimensionless numbers yet",
)
@pytest.mark.parametrize("seed", range(3))
def test_numbers_are_those_of_pedpy(seed):
    place, there = _crowd(seed)
    rows = [(i, f, *place[i, f]) for i, f in np.argwhere(there)]
    table = pd.DataFrame(rows, columns=["id", "frame", "x", "y"])
    walks = pedpy.TrajectoryData(table, frame_rate=RATE)
    near = pedpy.compute_intrusion(traj_data=walks, r_soc=0.8, l_min=0.2)
    soon = pedpy.compute_avoidance(traj_data=walks, frame_step=1, radius=0.4, tau_0=3.0)
    for i in range(CROWD):
        found = _numbers(place, there, i, np.full(CROWD, 0.2))
        others = np.arange(CROWD) != i
        apart = np.hypot(*(place[others] - place[i]).transpose(2, 0, 1))
        apart = np.where(there[others], apart, np.inf).min(axis=0)
        for pedpys, own, name, distance in (
            (near, found.intrusion, "intrusion", slow.CLOSEST),
            (soon, found.avoidance, "avoidance", 0.4),  # PedPy sees no collision in an overlap
        ):
            expected = np.zeros(FRAMES)
            mine = pedpys[pedpys.id == i]
            expected[mine.frame] = np.minimum(mine[name], np.inf if distance < 0.4 else 10.0)
            clear = there[i] & (apart > distance)
            np.testing.assert_allclose(own[0][clear], expected[clear], rtol=1e-9, atol=1e-12)


def _passing(person, velocity=(0.0, 0.0), own=(0.0, 0.0), seconds=2.0, preferred=1.0):
    walks = [
        Walk(straight((0.0, 0.0), own), (50.0, 0.0), 0.2, preferred),
        Walk(straight(person, velocity), (-50.0, 0.0), 0.2, driver=1),
    ]
    return record(walks, Setting(horizon=seconds))


def _value(name, episode):
    return values(load_metric(name), episode)[0]


def test_a_person_at_the_social_radius_has_the_number_1():
    assert _value("intrusion", _passing((0.8, 0.0))) == pytest.approx(1.0)
    assert _value("intrusion", _passing((0.4, 0.0))) == pytest.approx(9.0)
    assert _value("intrusion", _passing((2.41, 0.0))) == 0.0


def test_avoidance_is_the_reaction_time_over_the_time_to_collision():
    episode = _passing((5.0, 0.0), velocity=(-1.0, 0.0), seconds=2.0)  # 4.6 s to 2.6 s
    expected = np.mean(3.0 / (4.6 - np.arange(11) / 5.0))
    assert _value("avoidance", episode) == pytest.approx(expected)
    assert _value("avoidance", _passing((5.0, 0.0), velocity=(1.0, 0.0))) == 0.0


def test_only_its_own_approach_counts_in_personal_space():
    assert _value("personal_space_approach", _passing((1.0, 0.0))) == 0.0
    assert _value("personal_space_approach", _passing((1.5, 0.0), (-0.3, 0.0))) == 0.0
    assert _value("personal_space_approach", _passing((-0.5, 0.0), own=(0.3, 0.0))) == 0.0
    follows = _passing((1.0, 0.0), (0.3, 0.0), own=(0.3, 0.0), preferred=1.2)
    assert _value("personal_space_approach", follows) == pytest.approx(0.25)


def test_without_people_they_are_not_applicable():
    episode = record([Walk(straight((0.0, 0.0), (1.0, 0.0)), (3.0, 0.0))])
    metrics = [load_metric(name) for name in NAMES]
    for row in measure(episode, metrics):
        assert (row["missing"], row["defined"]) == ("n/a: needs people", 0)
        assert math.isnan(row["value"])
    assert failed_metrics(measured([episode], metrics)) == []
    for row in measure(_passing((1.0, 0.0)), metrics):
        assert (row["missing"], row["defined"]) == ("", 1)


def _simulated(drawn, command, twists=False):
    """The episode in which agents give the same commands (A, 2) until the end."""
    batch = Simulation([drawn])
    recorder = Recorder(batch)
    twist = np.broadcast_to(np.array(twists), (1, batch.A)).copy()
    recorder.record_kinds(twist)
    recorder.record_state()
    while batch.running.any():
        given = np.array([command], float)
        recorder.record_commands(given, batch.step(given, twist), 0.0)
        recorder.record_state()
    identity = Identity("a/b@1", "", "test", 0, "known", "same")
    return recorder.episodes([identity], 0.0, "", True, [()])[0]


@pytest.mark.parametrize(
    ("robot", "person", "fault"),
    [
        ((1.0, 0.0), (0.0, 0.0), 1),  # into a person who stands
        ((0.0, 0.0), (-1.0, 0.0), 0),  # a person walks into a robot that stands
        ((0.7, 0.0), (-1.0, 0.0), 1),  # both
        ((-0.3, 0.0), (-1.5, 0.0), 0),  # hit from behind while it leaves
        ((1.0, 0.0), (0.2, 0.0), 1),  # from behind into a person
    ],
)
@pytest.mark.parametrize("recorded", [False, True])
@pytest.mark.parametrize("unicycle", [False, True])
def test_the_agent_that_moves_into_a_person_is_at_fault(robot, person, fault, recorded, unicycle):
    start = np.array([[8.0, 10.0], [10.0, 10.0]])
    crew = agents(start, [[1.0, 1.0], [1.0, 19.0]], 0.3, unicycle=False, driver=[0, 1])
    if unicycle:
        facing = [0.0 if robot[0] >= 0.0 else math.pi, 0.0]
        crew = replace(crew, dynamics=np.array([1, 0], np.int8), heading=np.array(facing))
    bodies = []
    if recorded:
        crew = agents(start[0], [[1.0, 1.0]], 0.3, unicycle=unicycle, heading=crew.heading[0])
        way = start[1] + np.outer([0.0, 1.0], np.array(person) * 6.0)
        law = Law(LawKind.TRACK, np.array([0.0, 6.0]), way)
        bodies = [Body(disc(Kind.DYNAMIC, 0.0, 0.0, 0.3), law, person=True)]
    drawn = world(crew, bodies=bodies, steps=20)
    episode = _simulated(drawn, [robot] if recorded else [robot, person])
    assert collisions_people(episode)[0] == 1.0
    assert collisions_at_fault(episode)[0] == fault


def test_an_obstacle_with_another_law_is_no_person():
    law = Law(LawKind.TRACK, np.array([0.0, 6.0]), np.array([[10.0, 10.0], [4.0, 10.0]]))
    bodies = [Body(disc(Kind.DYNAMIC, 0.0, 0.0, 0.3), law)]
    drawn = world(agents([8.0, 10.0], [1.0, 1.0], 0.3), bodies=bodies, steps=20)
    episode = _simulated(drawn, [(1.0, 0.0)])
    assert len(episode.contacts) == 1
    assert np.isnan(collisions_people(episode)).all()


def _alone(contacts, rows, dt):
    """Rows whose agent and partner touch nothing earlier in that step: they follow the command."""
    for n in rows:
        begin, pair = int(contacts.start[n] / dt) * dt, (contacts.agent[n], contacts.partner[n])
        before = (contacts.start < contacts.start[n]) & (contacts.end >= begin - 1e-9)
        if not (before & np.isin(contacts.agent, pair)).any():
            yield n


def _crowded(seed):
    drawn = random_world(seed, 8, unicycle=[0, 1] * 4, steps=60)
    rng = np.random.default_rng(seed)
    return replace(drawn, agents=replace(drawn.agents, goal=drawn.agents.start[rng.permutation(8)]))


def test_the_approaches_of_both_add_up_to_the_closing_speed():
    """The simulator's closing speed comes from its own substeps and normals."""
    checked = 0
    for seed in range(12):
        episode = play(_crowded(seed), seed)
        c, dt = episode.contacts, episode.world.clock.dt
        rows = np.array(list(_alone(c, np.flatnonzero(c.kind == Kind.AGENT), dt)), np.int64)
        speed = dict(zip(rows.tolist(), own_approach(episode, rows).tolist(), strict=True))
        for n in rows:
            back = (c.agent == c.partner[n]) & (c.partner == c.agent[n]) & (c.start == c.start[n])
            for m in np.flatnonzero(back & (c.kind == Kind.AGENT)):
                if m in speed:
                    both = speed[n] + speed[m]
                    assert both == pytest.approx(c.closing_speed[n], abs=1e-6), (seed, n)
                    checked += 1
    assert checked > 10


@pytest.mark.parametrize(
    ("place", "command", "expected"),
    [
        ((2.0, 0.25), (1.0, 0.0), 1.0),  # its flat front, off its axis
        ((0.0, 1.0), (1.0, 0.0), 0.0),  # a person who walks into its side
        ((0.8, 0.65), (0.0, 2.0), 1.7),  # it turns on the spot, and its side sweeps into a person
    ],
)
def test_the_normal_is_that_of_the_shape(place, command, expected):
    """A bar of 2 m; a person of radius 0.2 m."""
    bar = {"half_length": [1.0, 0.2], "half_width": [0.4, 0.2], "rounding": [0.1, 0.0]}
    crew = agents(
        [[10.0, 10.0], [10.0 + place[0], 10.0 + place[1]]], [[1.0, 1.0], [1.0, 19.0]],
        [math.hypot(0.9, 0.3) + 0.1, 0.2], unicycle=[1, 0], driver=[0, 1], **bar,
    )  # fmt: skip
    person = (0.0, -1.0) if expected == 0.0 else (0.0, 0.0)
    episode = _simulated(world(crew, steps=10), [command, person], twists=[True, False])
    rows = np.flatnonzero(episode.contacts.agent == 0)[:1]
    assert own_approach(episode, rows) == pytest.approx([expected], abs=0.1)
    assert collisions_at_fault(episode)[0] == (expected > 0.0)


def test_recorded_people_come_and_go():
    law = Law(LawKind.TRACK, np.array([0.0, 1.0]), np.array([[1.0, 0.0], [1.0, 0.0]]))
    body = Body(disc(Kind.DYNAMIC, 0.0, 0.0, 0.2), law, person=True)

    def path(times):
        away = (times < 0.5) | (times > 1.0)
        return np.where(away[:, None], 1e7, np.array([[0.8, 0.0]]))

    setting = Setting(horizon=2.0, bodies=(body,), body_paths=(path,))
    walk = Walk(straight((0.0, 0.0), (0.0, 0.0)), (9.0, 0.0))
    found = analyse(record([walk], setting)).approaches
    np.testing.assert_allclose(found.intrusion[0], [0, 0, 0, 1, 1, 1, 0, 0, 0, 0, 0])
