"""Worlds that start again in a row, and the decision process of their agents."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from benchnav_baselines.learned.recurrent_ppo.actor import Actor
from benchnav_baselines.learned.recurrent_ppo.learning.evaluate import evaluate
from benchnav_baselines.learned.recurrent_ppo.sightings import Sightings
from benchnav_baselines.learned.recurrent_ppo.weights import write_weights

from benchnav.arena.solid import Kind
from benchnav.arena.world import ContactRule
from benchnav.envs.agent_batch import AgentBatch, Autoreset
from benchnav.envs.autoreset import KINDS, AutoresetSimulation
from benchnav.envs.background_agents import BackgroundCommands
from benchnav.envs.encoders.catalogue import encoder
from benchnav.envs.reward import RewardWeights
from benchnav.episode.episode import Status
from benchnav.generation.build import build
from benchnav.runner.rollouts.rollout import Assignment, rollout
from benchnav.scenario.catalogue import find
from benchnav.sensors.sense import sense
from benchnav.world.simulation import Simulation
from tests.worlds import agents, limited_world, random_world, walls, world

SENSORS = frozenset({"rays", "neighbours", "edges"})


@cache
def drawn(scenario, count, split="train"):
    return [build(find(scenario), split, seed) for seed in range(count)]


def mixed_pool():
    """Worlds of different numbers of obstacles and movers, under one clock and one set of rules."""
    names = ("leaders/dynamic", "leaders/static", "leaders/moving-furniture")
    return [world for name in names for world in drawn(name, 4)]


def steering(position, goal, heading, rng):
    """(A, 2) twists roughly at the goal."""
    way = goal - position
    error = np.arctan2(way[..., 1], way[..., 0]) - heading
    error = np.remainder(error + np.pi, 2 * np.pi) - np.pi
    noise = rng.normal(size=(*error.shape, 2)) * 0.5
    return np.stack([np.full_like(error, 1.5), 3 * error], axis=-1) + noise


def state(simulation, b, world):
    A, M = len(world.agents), len(world.bodies)
    names = ("position", "velocity", "heading", "status", "present", "arrival")
    bodies = ("body_position", "body_velocity")
    return (
        [getattr(simulation, name)[b, :A].copy() for name in names]
        + [getattr(simulation, name)[b, :M].copy() for name in bodies]
        + [simulation.steps_done[b], simulation.running[b], simulation.revision[b]]
    )


def arrays(readings):
    return [array for part in readings for name, array in vars(part).items() if name != "angle"]


@pytest.mark.parametrize("contact", ["as drawn", *ContactRule])
def test_a_row_that_starts_again_is_a_fresh_simulation(contact):
    pool = mixed_pool()
    if contact != "as drawn":
        counts = [2, 4, 3]
        pool = [random_world(k, counts[k % 3], contact, steps=40) for k in range(6)]
    rng = np.random.default_rng(0)
    relay = AutoresetSimulation(pool, 3)
    A = relay.A
    alone = [Simulation([pool[b]]) for b in range(3)]
    twist, restarts = np.ones((3, A), bool), 0
    for _ in range(120):
        again = np.flatnonzero(~relay.running | (rng.random(3) < 0.04))
        worlds = rng.integers(len(pool), size=len(again))
        relay.restart(again, worlds)
        for b, w in zip(again, worlds, strict=True):
            alone[b] = Simulation([pool[w]])
        restarts += len(again)
        readings = sense(relay, np.where(relay.present, np.arange(A), -1), SENSORS)
        command = steering(relay.position, relay.goal, relay.heading, rng)
        executed = relay.step(command, twist)
        for b, one in enumerate(alone):
            n = one.A
            who = np.where(one.present, np.arange(n), -1)
            for here, there in zip(arrays(readings), arrays(sense(one, who, SENSORS)), strict=True):
                np.testing.assert_array_equal(here[b, :n], there[0])
            np.testing.assert_array_equal(one.step(command[b, None, :n], twist[:1, :n])[0],
                                          executed[b, :n])  # fmt: skip
            for here, there in zip(
                state(relay, b, one.worlds[0]), state(one, 0, one.worlds[0]), strict=True
            ):
                np.testing.assert_array_equal(here, there)
    assert restarts > 6
    for b, one in enumerate(alone):
        for name, values in vars(one.contacts(0)).items():
            np.testing.assert_array_equal(getattr(relay.contacts(b), name), values)


def charged(contacts, width):
    """(A, KINDS) collision events."""
    counts = np.zeros((width, KINDS), int)
    for agent, kind, told in zip(contacts.agent, contacts.kind, contacts.charged, strict=True):
        counts[agent, kind] += bool(told)
    return counts


@pytest.mark.parametrize("contact", list(ContactRule))
def test_what_begun_counts_adds_up_to_the_contacts(contact):
    rng = np.random.default_rng(1)
    pool = [random_world(seed, 6, contact, steps=150) for seed in range(10)]
    relay = AutoresetSimulation(pool, 10)
    counts = np.zeros((10, relay.A, KINDS), int)
    for _ in range(150):
        running = relay.running.copy()
        relay.step(steering(relay.position, relay.goal, relay.heading, rng), relay.present | True)
        counts[running] += relay.begun()[running]
    for b in range(10):
        np.testing.assert_array_equal(counts[b], charged(relay.contacts(b), relay.A))
    kinds = set(np.flatnonzero(counts.sum((0, 1))))
    assert {Kind.AGENT, Kind.STATIC} <= kinds


def batch_of(pool, rows, name="ego", weights=None, seed=0, **more):
    rng = np.random.default_rng(seed)
    return AgentBatch(pool, rows, encoder(name), weights or RewardWeights(), rng, **more)


def decide(batch, rng):
    """(B, A, 2) actions roughly at the goal."""
    s = batch.simulation
    return np.clip(steering(s.position, s.goal, s.heading, rng) * [0.6, 0.4], -1, 1)


def speeds(pool, actions, **more):
    """(N,) [m/s] that each agent of the first world is commanded to drive by its ``actions``."""
    batch = batch_of(pool, 1, **more)
    batch.reset(np.zeros(1, np.int64))
    action = np.stack([np.asarray(actions, np.float32), np.zeros(len(actions), np.float32)], -1)
    simulation, given = batch.simulation, []
    simulation.step = lambda command, twist: (
        given.append(command.copy()) or Simulation.step(simulation, command, twist)
    )
    batch.step(action[None])
    return given[0][0, :, 0]


def test_actions_reach_full_speed_backwards_for_bodies_that_can_reverse():
    pool = [limited_world(2)]  # 2 m/s; all but the first agent can reverse
    np.testing.assert_array_equal(speeds(pool, [-1, -1, -1, -1]), [0.0, -2.0, -2.0, -2.0])
    np.testing.assert_array_equal(speeds(pool, [0, 0, 0.5, 1]), [1.0, 0.0, 1.0, 2.0])
    forward = speeds(pool, [-1, 0, 0.5, 1], reverse=False)
    np.testing.assert_array_equal(forward, [0.0, 1.0, 1.5, 2.0])


def test_a_body_that_can_reverse_drives_backwards_in_training():
    batch = batch_of([limited_world(2)], 1)
    batch.reset()
    for _ in range(3):
        batch.step(np.full((1, batch.width, 2), [-1.0, 0.0]))
    s = batch.simulation
    ahead = np.cos(s.heading) * s.velocity[..., 0] + np.sin(s.heading) * s.velocity[..., 1]
    np.testing.assert_array_less(ahead[0, 1:], -0.1)
    assert ahead[0, 0] > -1e-9


@pytest.mark.parametrize("scenario", ["leaders/dynamic", "corridor/bidirectional"])
def test_an_attempt_ends_and_its_slot_idles_until_the_row_starts_again(scenario):
    batch, rng = batch_of(drawn(scenario, 6), 4), np.random.default_rng(2)
    x = batch.reset()
    before, ends = batch.active.copy(), 0
    for _ in range(300):
        step = batch.step(decide(batch, rng))
        assert (step.acted == before).all()
        np.testing.assert_array_equal(step.over & ~step.acted, False)
        assert (step.arrived.astype(int) + step.touched + step.timed_out <= 1).all()
        left = step.acted & ~step.over
        fresh = ~left.any(1)
        assert (step.restarted.any(1) == fresh).all()
        np.testing.assert_array_equal(batch.active, np.where(fresh[:, None], step.restarted, left))
        assert (step.reward[~step.acted] == 0).all()
        assert (step.observation[~batch.active] == 0).all()
        assert step.observation[batch.active].any(axis=-1).all()
        np.testing.assert_array_equal(step.observation[left], step.final[left])
        before, ends, x = batch.active.copy(), ends + int(step.over.sum()), step.observation
    assert ends > 40
    assert np.isfinite(x).all()


def test_every_world_of_the_pool_comes_once_a_pass():
    pool = drawn("leaders/dynamic", 7)
    batch, rng = batch_of(pool, 3), np.random.default_rng(3)
    batch.reset()
    number = {id(world): k for k, world in enumerate(batch.simulation.pool)}
    order = [number[id(world)] for world in batch.simulation.worlds]
    while len(order) < 28:
        step = batch.step(decide(batch, rng))
        rows = np.flatnonzero(step.restarted.any(1))
        order += [number[id(batch.simulation.worlds[b])] for b in rows]
    passes = [tuple(order[k : k + 7]) for k in range(0, 28, 7)]
    assert all(sorted(one) == list(range(7)) for one in passes)
    assert len(set(passes)) > 1


def test_the_order_of_worlds_depends_on_the_generator_alone():
    pool = drawn("leaders/dynamic", 7)

    def first(seed):
        batch = batch_of(pool, 5, seed=seed)
        batch.reset()
        return [batch.simulation.pool.index(world) for world in batch.simulation.worlds]

    assert first(1) == first(1) != first(2)
    batch = batch_of(pool, 5, seed=3)
    batch.reset()
    batch.reseed(np.random.default_rng(1))
    batch.reset()
    assert [batch.simulation.pool.index(w) for w in batch.simulation.worlds] == first(1)


def test_no_row_learns_of_the_others():
    pool = drawn("leaders/dynamic", 4)
    together, alone = batch_of(pool, 4), batch_of(pool, 1)
    x, one = together.reset(np.arange(4)), alone.reset(np.array([2]))
    rng = np.random.default_rng(4)
    for _ in range(25):
        np.testing.assert_array_equal(x[2], one[0])
        action = decide(together, rng)
        a, b = together.step(action), alone.step(action[2:3])
        np.testing.assert_array_equal(a.reward[2], b.reward[0])
        x, one = a.observation, b.observation
        if a.restarted[2].any():
            return


def test_actions_span_what_the_body_can_do():
    crew = agents([[4.0, 4.0], [12.0, 12.0]], [[18.0, 4.0], [18.0, 12.0]], unicycle=True)
    for v, w, expected in [(-1, 0, (0, 0)), (1, 0, (2, 0)), (0, 1, (1, 2.5)), (9, -9, (2, -2.5))]:
        batch = batch_of([world(crew)], 1)
        batch.reset()
        batch.step(np.broadcast_to(np.array([v, w], float), (1, 2, 2)))
        s = batch.simulation
        np.testing.assert_allclose(np.hypot(*s.velocity[0].T), expected[0], atol=1e-12)
        np.testing.assert_allclose(s.heading[0], 0.2 * expected[1], atol=1e-12)


def test_the_reward_of_a_decision_by_hand():
    """One drives at full speed at its goal, one away from its own, one against a wall."""
    crew = agents(
        [[4.0, 4.0], [12.0, 12.0], [19.4, 8.0]], [[18.0, 4.0], [2.0, 12.0], [2.0, 8.0]],
        unicycle=True,
    )  # fmt: skip
    weights = RewardWeights(approach=2, walls=30, time=1, turning=3, moving="progress", scale=0.5)
    batch = batch_of([world(crew, [walls(20.0)])], 1, weights=weights)
    batch.reset()
    step = batch.step(np.array([[[1.0, 0.0], [0.0, 0.0], [1.0, 0.0]]]))
    np.testing.assert_allclose(step.terms.approach[0, :2], [2, -1])
    np.testing.assert_allclose(step.terms.walls[0], [0, 0, -30])
    np.testing.assert_allclose(step.reward[0, :2], [0.5 * (2 - 1), 0.5 * (-1 - 1)])
    assert step.touched[0].tolist() == [False, False, True]


def test_somebody_else_may_drive_a_slot():
    crew = agents([[4.0, 4.0], [12.0, 12.0]], [[18.0, 4.0], [18.0, 12.0]])
    batch = batch_of([world(crew)], 1)
    batch.reset()
    command = np.array([[[0.0, 0.0], [0.0, -1.5]]])
    background = BackgroundCommands(np.array([[False, True]]), command, twist=False)
    batch.step(np.zeros((1, 2, 2)), background)
    np.testing.assert_allclose(batch.simulation.velocity[0], [[1, 0], [0, -1.5]], atol=1e-12)


def test_what_learners_command_may_be_corrected():
    crew = agents([[4.0, 4.0], [12.0, 12.0]], [[18.0, 4.0], [18.0, 12.0]])

    def slower(seen, bodies, command, tolerance):
        assert seen.active.all()
        assert tolerance.tolist() == [[0.3, 0.3]]
        assert (command[..., 0] == bodies.max_speed).all()
        return 0.5 * command

    batch = batch_of([world(crew)], 1, correct=slower)
    batch.reset()
    batch.step(np.array([[[1.0, 0.0], [1.0, 0.0]]]))
    speed = batch.simulation.agents["max_speed"][0]
    np.testing.assert_allclose(batch.simulation.velocity[0, :, 0], 0.5 * speed)


def test_agents_with_a_driver_learn_nothing_and_are_driven():
    worlds = drawn("crowd/circle-crossing", 3)
    batch = batch_of(worlds, 2, drivers=find("crowd/circle-crossing").driver_specs)
    batch.reset(np.array([0, 1]))
    assert batch.active.tolist() == [[True] + 5 * [False]] * 2
    start = batch.simulation.position.copy()
    for _ in range(4):  # one second
        step = batch.step(np.full((2, 6, 2), -1.0))
        assert step.acted.tolist() == [[True] + 5 * [False]] * 2
    moved = np.linalg.norm(batch.simulation.position - start, axis=-1)
    assert (moved[:, 0] == 0).all()
    assert (moved[:, 1:] > 0.5).all()


def at_the_goal(noise=0.0):
    """Weights that steer at the goal, with random ones beside them and an LSTM before."""
    rng = np.random.default_rng(0)
    names = [number.name for number in encoder("ego").numbers]
    output = noise * rng.normal(size=(62, 2)).astype(np.float32)
    output[names.index("goal.sin"), 1] += 1.5
    return {"output.weight": output, "output.bias": np.array([0.5, 0.0], np.float32)}


STEERING = at_the_goal()


def remembering():
    rng = np.random.default_rng(0)

    def draw(*shape):
        return (0.4 * rng.normal(size=shape)).astype(np.float32)

    return {
        "lstm0.weight": draw(70, 32), "lstm0.bias": draw(32),
        "output.weight": draw(8, 2), "output.bias": np.array([0.3, 0.0], np.float32),
    }  # fmt: skip


@pytest.mark.parametrize("tensors", [STEERING, at_the_goal(0.1), remembering()])
@pytest.mark.parametrize(
    "scenario", ["leaders/dynamic", "leaders/static-corner", "crowd/circle-crossing"]
)
def test_strict_success_is_what_the_runner_records(tensors, scenario, tmp_path):
    path, worlds = tmp_path / "w.safetensors", drawn(scenario, 12, "validation")
    write_weights(path, tensors, {"encoder": "ego", "progress": {"decisions": 0, "seconds": 0.0}})
    drivers = find(scenario).driver_specs
    arrived = evaluate(Actor(tensors), batch_of(worlds, 12, drivers=drivers))
    spec = {"type": "recurrent-ppo", "weights": str(path)}
    run = Assignment(scenario, "hash", "validation", "unknown", "own", spec, drivers)
    episodes = [e for batch in rollout(run, list(enumerate(worlds))) for e in batch]
    assert sorted(episode.identity.seed for episode in episodes) == list(range(12))
    for episode in episodes:
        assert not episode.failure
        there = episode.status[-1] == Status.ARRIVED
        there &= episode.world.agents.evaluated
        np.testing.assert_array_equal(arrived[episode.identity.seed], there)
        assert not np.isin(episode.contacts.agent, np.flatnonzero(there)).any()
    if tensors is STEERING and not drivers:
        assert 0 < arrived.mean() < 1


@pytest.mark.parametrize("remembers", [False, True])
def test_what_learners_remember_they_perceive_in_runs_too(remembers, tmp_path):
    """Each number of the encoding changes the commands, and so the final positions."""
    path, worlds = tmp_path / "w.safetensors", drawn("leaders/dynamic", 8, "validation")
    chosen = encoder("dynamic-window")
    output = 0.05 * np.random.default_rng(0).normal(size=(chosen.size, 2)).astype(np.float32)
    output[[n.name for n in chosen.numbers].index("goal.sin"), 1] += 1.5
    tensors = {"output.weight": output, "output.bias": np.array([0.2, 0.0], np.float32)}
    about = {"encoder": "dynamic-window", "progress": {"decisions": 0, "seconds": 0.0}}
    write_weights(path, tensors, about | {"hidden_movers": remembers})
    actor, ends = Actor(tensors), {}
    for memory in (None, Sightings(rays=False)):
        batch = batch_of(
            worlds, 8, "dynamic-window", memory=memory, autoreset=Autoreset.DISABLED, reverse=False
        )
        ends[memory is not None] = last_positions(actor, batch)
    assert (ends[False] != ends[True]).any()
    run = Assignment(
        "leaders/dynamic", "hash", "validation", "unknown", "own",
        {"type": "recurrent-ppo-plus", "weights": str(path), "foresight": False, "patience": 0},
    )  # fmt: skip
    for batch in rollout(run, list(enumerate(worlds))):
        for episode in batch:
            expected = ends[remembers][episode.identity.seed]
            assert not episode.failure
            np.testing.assert_array_equal(
                episode.position[-1], expected[: len(episode.world.agents)]
            )


@pytest.mark.parametrize("autoreset", [Autoreset.SAME_STEP, Autoreset.NEXT_STEP])
def test_a_row_that_starts_again_has_forgotten_everything(autoreset):
    worlds = drawn("leaders/dynamic", 2, "validation")
    batch = batch_of(worlds, 1, "dynamic-window", memory=Sightings(rays=False), autoreset=autoreset)
    batch.reset(np.array([0]))
    batch._queue = np.array([1])
    fast = np.ones((1, batch.width, 2)) * [1.0, 0.1]
    for _ in range(worlds[0].clock.steps + 2):
        step = batch.step(fast)
        if step.restarted.any():
            break
    fresh = batch_of(worlds, 1, "dynamic-window", memory=Sightings(rays=False))
    np.testing.assert_array_equal(step.observation, fresh.reset(np.array([1])))


def last_positions(actor, batch):
    """(B, A, 2) [m] at the end of the first worlds."""
    evaluate(actor, batch)
    return batch.simulation.position.copy()


def test_every_array_with_a_row_for_each_world_of_the_pool_has_one_for_each_row():
    worlds = [random_world(seed) for seed in range(7)]

    def lengths(simulation):
        return {
            name: len(value)
            for name, value in vars(simulation).items()
            if isinstance(value, np.ndarray)
        }

    few, all_, rows = (
        lengths(simulation)
        for simulation in (
            Simulation(worlds[:5]), Simulation(worlds), AutoresetSimulation(worlds[:5], 11)
        )
    )  # fmt: skip
    by_world = {name for name in few if (few[name], all_[name]) == (5, 7)}
    assert {"agents", "hashed", "spots", "near", "position"} <= by_world
    assert {rows[name] for name in by_world} == {11}


def test_agents_that_enter_later_are_driven_from_then_on():
    drawn_world = drawn("crowd/circle-crossing", 1)[0]
    enters = np.array([0.0, 0.0, 0.5, 0.5, 1.0, 99.0])
    late = replace(drawn_world, agents=replace(drawn_world.agents, enters=enters))
    batch = batch_of([late], 1, drivers=find("crowd/circle-crossing").driver_specs)
    batch.reset(np.array([0]))
    start, dt = batch.simulation.position[0].copy(), late.clock.dt
    for k in range(8):
        here = enters <= k * dt + 1e-9
        assert batch.simulation.present[0].tolist() == here.tolist()
        batch.step(np.full((1, 6, 2), -1.0))
    moved = np.linalg.norm(batch.simulation.position[0] - start, axis=-1)
    assert (moved[1:5] > 0.3).all()
    assert moved[5] == 0.0
    batch.reset(np.array([0]))
    assert batch.simulation.present[0].tolist() == [True, True, False, False, False, False]
