from dataclasses import replace

import numpy as np
import pytest
from benchnav_baselines.common.tensor_file import read_tensors, write_tensors
from benchnav_baselines.learned.q_learning.encoder import (
    DIRECTIONS,
    LEVELS,
    SITUATIONS,
    pick_rays,
    situations,
)
from benchnav_baselines.learned.q_learning.learner import Learner, chosen
from benchnav_baselines.learned.q_learning.moves import MOVES, twists
from benchnav_baselines.learned.q_learning.navigator import QLearning
from benchnav_baselines.learned.q_learning.recipe import Recipe
from benchnav_baselines.learned.q_learning.table import Table, load, save
from benchnav_baselines.learned.q_learning.table_pilot import SHIPPED
from benchnav_baselines.learned.q_learning.train import train
from benchnav_baselines.learned.q_learning.trainer import QLearningTrainer

from benchnav.arena.solid import Kind
from benchnav.config.yaml_reader import read_yaml, validate
from benchnav.errors import BenchnavError, ConfigError, PluginError, UsageError
from benchnav.navigation.observation import Observation
from benchnav.navigation.plugin.configure import make
from benchnav.plugins import NAVIGATORS
from benchnav.sensors.readings import Rays
from benchnav.testing.check_navigator import check_navigator
from tests.baselines.crowds import answers, briefing

TINY = Recipe(name="tiny", trainer="q-learning", rounds=6, decisions=5, worlds=6, patience=15)


def view(goal, distance, kind=0, approach=0.0, heading=0.0):
    """One agent at the origin with seven rays; ``distance`` and ``kind`` per ray or for all."""
    shape = (1, 1, 7)
    rays = Rays(
        np.deg2rad(DIRECTIONS), np.broadcast_to(np.array(distance, float), shape).copy(),
        np.broadcast_to(np.array(kind, np.int8), shape).copy(), np.full(shape, approach),
        np.full(shape, np.inf),
    )  # fmt: skip
    return Observation(
        rows=np.zeros(1, np.int64),
        time=np.zeros(1),
        active=np.ones((1, 1), bool),
        position=np.zeros((1, 1, 2)),
        heading=np.full((1, 1), heading),
        velocity=np.zeros((1, 1, 2)),
        goal=np.array([[goal]], float),
        maps=(None,),
        rays=rays,
    )


def digits(seen, speed=2.0, tolerance=0.5):
    """The situation, digit by digit as in LEVELS."""
    one = np.ones(seen.active.shape)
    return np.unravel_index(int(situations(seen, speed * one, tolerance * one)[0, 0]), LEVELS)


def test_it_is_a_navigator():
    check_navigator(QLearning)


def test_what_ships_was_trained_as_it_says():
    about = load(SHIPPED).about
    assert int(about["steps"]) > 1_000_000
    assert float(about["seconds"]) < 120.0
    assert len(load(SHIPPED).situation) > 10_000


def test_every_digit_of_a_situation_says_what_it_should():
    assert digits(view((9, 0), 8.0)) == (4, 1, 4, 3, 3, 2, 2, 0)
    assert digits(view((0, 9), 8.0))[0] == 7  # to the left
    assert digits(view((0, -9), 8.0))[0] == 1
    assert digits(view((0, 9), 8.0, heading=np.pi / 2))[0] == 4
    assert digits(view((1, 0), 8.0))[1] == 0
    wall = int(Kind.WALL)
    assert digits(view((0, 9), 0.1, wall))[2:] == (0, 0, 0, 0, 0, 0)
    left = [8, 8, 8, 8, 0.3, 0.1, 8]
    assert digits(view((0, -9), left, wall))[2:] == (4, 0, 3, 0, 2, 0)


def test_what_lies_behind_the_goal_is_not_in_its_way():
    wall = int(Kind.WALL)
    assert digits(view((2, 0), 1.6, wall))[2] == 4
    assert digits(view((2, 0), 1.4, wall))[2] == 2


@pytest.mark.parametrize(("ray", "side"), [(0, 1), (1, 1), (2, 2), (3, 2), (4, 2), (5, 3), (6, 3)])
def test_the_side_on_which_somebody_is_near(ray, side):
    distance, kind = np.full(7, 8.0), np.zeros(7)
    distance[ray], kind[ray] = 3.0, int(Kind.AGENT)
    assert digits(view((0, 9), distance, kind))[-1] == side
    distance[ray] = 4.0
    assert digits(view((0, 9), distance, kind))[-1] == 0


def test_a_mover_that_comes_on_is_taken_nearer():
    distance, kind = np.full(7, 8.0), np.full(7, int(Kind.DYNAMIC))
    distance[3] = 1.2
    assert digits(view((0, 9), distance, kind))[2] == 2
    assert digits(view((0, 9), distance, kind, approach=1.5))[2] == 0
    assert digits(view((0, 9), distance, kind, approach=-1.5))[2] == 2


def test_a_slow_agent_measures_in_its_own_seconds():
    near = digits(view((0, 4.5), 2.2, int(Kind.WALL)), speed=1.0)
    assert near == digits(view((0, 9), 4.4, int(Kind.WALL)), speed=2.0)


def test_other_fans_are_read_at_the_nearest_rays():
    assert pick_rays(np.deg2rad(DIRECTIONS)).tolist() == list(range(7))
    assert pick_rays(np.linspace(-np.pi / 2, np.pi / 2, 13)).tolist() == list(range(0, 13, 2))
    assert pick_rays(np.zeros(1)).tolist() == [0] * 7


def slow_update(values, visits, transitions, discount, rate):
    """One transition after the other, those of one (state, action) together by their mean."""
    old, groups = values.copy(), {}
    for state, action, reward, after, ended in transitions:
        target = reward if ended else reward + discount * max(old[after])
        groups.setdefault((state, action), []).append(target)
    for at, targets in groups.items():
        visits[at] += len(targets)
        left = 1.0
        for _ in targets:
            left *= 1.0 - rate
        share = max(1.0 - left, len(targets) / visits[at])
        values[at] += share * (sum(targets) / len(targets) - old[at])


def test_the_update_equals_a_slow_twin():
    rng = np.random.default_rng(0)
    learner = Learner(rng.normal(size=(6, 3)), 0.9)
    values, visits = learner.values.copy(), np.zeros((6, 3), np.int64)
    for _ in range(20):
        state, after = rng.integers(6, size=(2, 17))
        action, reward = rng.integers(3, size=17), rng.normal(size=17)
        ended = rng.random(17) < 0.2
        learner.update(state, action, reward, after, ended, 0.05)
        slow_update(
            values, visits, zip(state, action, reward, after, ended, strict=True), 0.9, 0.05
        )
        np.testing.assert_allclose(learner.values, values, rtol=1e-12)
    np.testing.assert_array_equal(learner.visits, visits)


def test_it_learns_the_values_of_a_chain():
    """States 0 … 4, left or right, 1 at the right end: Q = γ^(steps to go), exactly."""
    learner, rng = Learner(np.zeros((5, 2)), 0.5), np.random.default_rng(1)
    for _ in range(400):
        state, action = rng.integers(5, size=8), rng.integers(2, size=8)
        then = np.clip(state + 2 * action - 1, 0, 4)
        ended = (state == 4) & (action == 1)
        learner.update(state, action, ended.astype(float), then, ended, 1.0)
    np.testing.assert_allclose(learner.values[:, 1], 0.5 ** np.arange(4, -1, -1))
    np.testing.assert_allclose(learner.values[1:, 0], 0.5 ** np.arange(5, 1, -1))


def test_exploring_moves_are_drawn_and_others_are_the_best():
    values, state = np.tile([0.0, 1.0, 0.0], (4, 1)), np.zeros(3000, np.int64)
    rng = np.random.default_rng(2)
    assert (chosen(values, state, 0.0, rng) == 1).all()
    assert np.mean(chosen(values, state, 0.3, rng) != 1) == pytest.approx(0.2, abs=0.03)


def test_training_repeats_bit_for_bit_and_depends_on_the_seed():
    first, again, other = (train(TINY, seed, lambda report: None) for seed in (3, 3, 4))
    assert first[1] == again[1] > 100
    np.testing.assert_array_equal(first[0].values, again[0].values)
    assert not np.array_equal(first[0].values, other[0].values)


def test_the_trainer_writes_a_table_that_the_navigator_takes(tmp_path):
    trainer, reports = QLearningTrainer(), []
    options = {"resume": False, "device": "cpu", "report": reports.append}
    trainer.train(TINY, 1, tmp_path, **options)
    assert reports[-1].decisions == reports[-1].total > 0
    file = tmp_path / "weights.safetensors"
    assert load(file).about["seed"] == "1"
    QLearning(QLearning.Config(table=file))
    with pytest.raises(UsageError, match="must be a new folder"):
        trainer.train(TINY, 1, tmp_path, **options)
    with pytest.raises(UsageError, match="keeps no checkpoints"):
        trainer.train(TINY, 1, tmp_path, **{**options, "resume": True})


def test_the_shipped_recipe_is_what_the_shipped_table_was_trained_with():
    (path,) = QLearningTrainer.recipes.glob("*.yaml")
    shipped = validate(Recipe, read_yaml(path))
    assert (shipped.rounds, shipped.decisions, shipped.worlds) == (700, 8, 1024)
    assert shipped.scenarios == ("leaders/static", "leaders/dynamic")


def test_commands_are_no_more_than_the_moves():
    rng, seen, navigator = np.random.default_rng(5), [], QLearning()
    for _ in range(300):
        goal, distance = rng.uniform(-9, 9, 2), rng.uniform(0, 8, 7)
        told = briefing([(0, 0)], [goal])
        seen.append(answers(navigator, [told], view(goal, distance, rng.integers(0, 6, 7)))[0, 0])
    distinct = np.unique(np.array(seen), axis=0)
    assert 5 < len(distinct) <= len(MOVES)
    assert {tuple(c) for c in distinct} <= {
        tuple(c) for c in twists(np.arange(len(MOVES)), np.ones(15), np.full(15, 2.5))
    }


def table(situation=(0, 7)):
    learner = Learner(np.zeros((SITUATIONS, len(MOVES))), 0.9)
    for k in situation:
        learner.values[k, k % len(MOVES)] = learner.visits[k, k % len(MOVES)] = 1
    return Table.of(learner, seed=0, steps=2)


def test_a_table_survives_its_file_and_untried_moves_are_never_chosen(tmp_path):
    kept = replace(table(), values=table().values - 5.0)
    save(tmp_path / "t.safetensors", kept)
    read = load(tmp_path / "t.safetensors")
    np.testing.assert_array_equal(read.situation, [0, 7])
    np.testing.assert_array_equal(read.values, kept.values)
    assert read.about == {**kept.about, "sha256": read.about["sha256"]}
    assert read.policy()[[0, 7]].tolist() == [0, 7]
    assert tuple(MOVES[read.policy()[8]]) == (0.0, -1.0)  # never met


def refiled(path, *, about=(), **arrays):
    """The same file with other facts or arrays; None leaves one out."""
    file = read_tensors(path)
    kept = {name: t for name, t in {**file.tensors, **arrays}.items() if t is not None}
    write_tensors(path, kept, {**file.about, **dict(about)})


SPOILED = {
    "nothing": (lambda path: path.write_bytes(b""), "complete safetensors"),
    "cut in the header": (lambda p: p.write_bytes(p.read_bytes()[:40]), "complete safetensors"),
    "cut in the arrays": (lambda p: p.write_bytes(p.read_bytes()[:-3]), "complete safetensors"),
    "text": (lambda path: path.write_bytes(b"not a table, but text"), "complete safetensors"),
    "other encoder": (
        lambda path: refiled(path, about={"encoder": "x-1"}),
        "encoder 'x-1' instead of 'q-7rays-1'",
    ),
    "other moves": (lambda path: refiled(path, about={"moves": "[]"}), "the moves"),
    "no values": (lambda path: refiled(path, values=None), "'values'"),
    "other kind": (
        lambda path: refiled(path, values=np.zeros((2, len(MOVES)))), "float64 where 'values'"
    ),
    "odd shape": (
        lambda path: refiled(path, values=np.zeros((2, 3), np.float32)), "arrays of shape"
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", SPOILED)
def test_a_spoiled_table_is_refused_with_what_where_and_why(name, tmp_path):
    spoil, reason = SPOILED[name]
    file = tmp_path / "t.safetensors"
    save(file, table())
    spoil(file)
    with pytest.raises(PluginError) as caught:
        QLearning(QLearning.Config(table=file))
    assert reason in str(caught.value)
    assert str(file) in str(caught.value)


@pytest.mark.parametrize("situation", [(SITUATIONS,), (5, 5), (-1, 3)])
def test_situations_that_there_are_not_are_refused(situation, tmp_path):
    values = np.zeros((len(situation), len(MOVES)))
    bad = Table(np.array(situation), values, table().about)
    save(tmp_path / "t.safetensors", bad)
    with pytest.raises(PluginError, match="do not rise"):
        load(tmp_path / "t.safetensors")


def test_a_missing_table_and_a_wrong_parameter_are_mistakes_of_the_user(tmp_path):
    spec = {"type": "benchnav_baselines.learned.q_learning.navigator:QLearning"}
    with pytest.raises(BenchnavError, match="cannot be read"):
        make(NAVIGATORS, {**spec, "table": str(tmp_path / "none.safetensors")})
    with pytest.raises(ConfigError, match="'tabel'"):
        make(NAVIGATORS, {**spec, "tabel": "x"})
