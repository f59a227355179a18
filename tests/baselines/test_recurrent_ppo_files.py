"""Weights and checkpoints on disk: what is written is read, and nothing else is."""

import json
from types import SimpleNamespace

import numpy as np
import pytest
import torch
import yaml
from benchnav_baselines.learned.recurrent_ppo.learning import checkpoint
from benchnav_baselines.learned.recurrent_ppo.learning.checkpoint import Progress
from benchnav_baselines.learned.recurrent_ppo.learning.recipe import Recipe
from benchnav_baselines.learned.recurrent_ppo.learning.trainer import RecurrentPPOTrainer
from benchnav_baselines.learned.recurrent_ppo.policy_at_work import SHIPPED
from benchnav_baselines.learned.recurrent_ppo.weights import FORMAT, read_weights, write_weights
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from safetensors.numpy import save

from benchnav.errors import PluginError, StoreError, UsageError
from studies.ship_training import include

ABOUT = {
    "format": "benchnav-actor-1",
    "encoder": "ego",
    "progress": {"decisions": 5, "seconds": 1.0},
    "success": {"leaders/static": 0.5},
}


def tensors_of(inputs=62, size=4, dense=5):
    rng = np.random.default_rng(0)
    shapes = {
        "lstm0.weight": (inputs + size, 4 * size), "lstm0.bias": (4 * size,),
        "lstm1.weight": (2 * size, 4 * size), "lstm1.bias": (4 * size,),
        "dense0.weight": (size, dense), "dense0.bias": (dense,),
        "output.weight": (dense, 2), "output.bias": (2,),
    }  # fmt: skip
    return {name: rng.normal(size=shape).astype(np.float32) for name, shape in shapes.items()}


def changed(**tensors):
    return {**tensors_of(), **{name.replace("_", "."): value for name, value in tensors.items()}}


def refused(path):
    with pytest.raises(PluginError) as caught:
        read_weights(path)
    said = str(caught.value)
    assert said.startswith(f"{path}: ")
    assert said.endswith(".")
    return said


@pytest.fixture
def path(tmp_path):
    return tmp_path / "weights.safetensors"


def test_what_is_written_is_read(path):
    tensors = tensors_of()
    write_weights(path, tensors, ABOUT)
    actor, about = read_weights(path)
    assert {**about, "sha256": None} == {**ABOUT, "sha256": None, "hidden_movers": False}
    assert actor.state_size == 16
    np.testing.assert_array_equal(actor.lstm[1].weight, tensors["lstm1.weight"])
    np.testing.assert_array_equal(actor.dense[0].bias, tensors["dense0.bias"])
    np.testing.assert_array_equal(actor.output.weight, tensors["output.weight"])
    assert [entry.name for entry in path.parent.iterdir()] == [path.name]


def test_views_are_written_as_they_look(path):
    turned = np.asfortranarray(tensors_of()["output.weight"])
    write_weights(path, changed(output_weight=turned), ABOUT)
    np.testing.assert_array_equal(read_weights(path)[0].output.weight, turned)


@pytest.mark.parametrize("share", [0.0, 0.001, 0.01, 0.5, 0.99, 0.9999])
def test_a_file_that_is_cut_short_is_refused(path, share):
    write_weights(path, tensors_of(), ABOUT)
    data = path.read_bytes()
    path.write_bytes(data[: int(len(data) * share)])
    assert "complete safetensors file" in refused(path)


@given(st.binary(max_size=200))
@settings(max_examples=50, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_random_bytes_are_refused(path, data):
    path.write_bytes(data)
    refused(path)


@pytest.mark.parametrize("length", [0, 2, 10**6, 2**63])
def test_a_header_that_lies_about_its_length_is_refused(path, length):
    path.write_bytes(length.to_bytes(8, "little") + b"{}")
    refused(path)


def test_a_missing_file_and_a_folder_are_refused(path, tmp_path):
    assert "cannot be read" in refused(path)
    assert "cannot be read" in refused(tmp_path)


@pytest.mark.parametrize("metadata", [None, {}, {"format": "pt"}])
def test_somebody_else_s_safetensors_are_refused(path, metadata):
    path.write_bytes(save(tensors_of(), metadata))
    assert f"format {FORMAT!r}" in refused(path)


def test_an_unknown_encoder_is_refused(path):
    write_weights(path, tensors_of(), {**ABOUT, "encoder": "sonar"})
    assert "the encoder 'sonar', which does not exist" in refused(path)
    write_weights(path, tensors_of(), {"encoder": "ego"})
    assert "must have the facts of its training" in refused(path)


def test_another_encoder_s_weights_are_refused(path):
    write_weights(path, tensors_of(), {**ABOUT, "encoder": "ego-static"})
    said = refused(path)
    assert "lstm0 must have the shape (52, 16) for the encoder 'ego-static'" in said
    assert "(66, 16)" in said


@pytest.mark.parametrize(
    ("name", "shape"),
    [
        ("lstm0.weight", (66, 15)),
        ("lstm1.weight", (9, 16)),
        ("dense0.weight", (5, 4)),
        ("output.weight", (5, 3)),
        ("output.weight", (10, 1)),
        ("output.bias", (3,)),
    ],
)
def test_shapes_that_do_not_fit_are_refused(path, name, shape):
    write_weights(path, {**tensors_of(), name: np.zeros(shape, np.float32)}, ABOUT)
    assert f"{name.partition('.')[0]} must have the shape" in refused(path)


@pytest.mark.parametrize("name", ["lstm0.weight", "dense0.weight", "output.bias", "output.weight"])
def test_a_tensor_that_lacks_is_named(path, name):
    tensors = tensors_of()
    del tensors[name]
    write_weights(path, tensors, ABOUT)
    assert f"'{name}' must be there" in refused(path)


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_what_is_not_finite_is_refused(path, value):
    tensors = tensors_of()
    tensors["dense0.bias"][3] = value
    write_weights(path, tensors, ABOUT)
    assert "dense0.bias must be finite" in refused(path)


def test_another_precision_is_refused(path):
    write_weights(path, changed(output_bias=np.zeros(2)), ABOUT)
    assert "output.bias must be float32. Got float64" in refused(path)


def learner_of(seed):
    """As much of a learner as a checkpoint needs, after a step of Adam."""
    torch.manual_seed(seed)
    policy = torch.nn.Linear(3, 2)
    policy.optimizer = torch.optim.Adam(policy.parameters(), lr=0.1)
    policy(torch.ones(1, 3)).sum().backward()
    policy.optimizer.step()
    return SimpleNamespace(policy=policy)


def assert_same(one, other):
    for a, b in zip(one.policy.parameters(), other.policy.parameters(), strict=True):
        assert torch.equal(a, b)
    states = [learner.policy.optimizer.state_dict()["state"] for learner in (one, other)]
    assert states[0].keys() == states[1].keys()
    for index, state in states[0].items():
        assert all(torch.equal(value, states[1][index][name]) for name, value in state.items())


PROGRESS = Progress("abc", 3, segment=2, stage=1, decisions=500, in_stage=100, best=0.5, waited=1)


def test_a_checkpoint_holds_all_that_training_goes_on_from(tmp_path):
    one, other = learner_of(0), learner_of(1)
    checkpoint.save(tmp_path, one, PROGRESS)
    assert checkpoint.load(tmp_path, other, "abc", 3) == PROGRESS
    assert_same(one, other)
    for learner in (one, other):
        learner.policy.optimizer.step()
    assert_same(one, other)
    assert [entry.name for entry in tmp_path.iterdir()] == [checkpoint.FILE]


def test_a_checkpoint_from_before_the_first_update_is_whole(tmp_path):
    one, other = learner_of(0), learner_of(0)
    for learner in (one, other):
        learner.policy.optimizer = torch.optim.Adam(learner.policy.parameters())
    checkpoint.save(tmp_path, one, Progress("abc", 3))
    assert checkpoint.load(tmp_path, other, "abc", 3) == Progress("abc", 3)
    assert_same(one, other)


@pytest.mark.parametrize(("recipe", "seed"), [("abd", 3), ("abc", 4)])
def test_another_training_s_checkpoint_is_refused(tmp_path, recipe, seed):
    checkpoint.save(tmp_path, learner_of(0), PROGRESS)
    untouched, learner = learner_of(1), learner_of(1)
    with pytest.raises(UsageError, match="recipe abc with seed 3") as caught:
        checkpoint.load(tmp_path, learner, recipe, seed)
    assert f"got recipe {recipe} with seed {seed}" in str(caught.value)
    assert_same(learner, untouched)


@pytest.mark.parametrize("share", [0.0, 0.005, 0.1, 0.5, 0.99])
def test_a_checkpoint_that_is_cut_short_is_refused(tmp_path, share):
    checkpoint.save(tmp_path, learner_of(0), PROGRESS)
    path = tmp_path / checkpoint.FILE
    data = path.read_bytes()
    path.write_bytes(data[: int(len(data) * share)])
    with pytest.raises(StoreError, match="must be a complete checkpoint") as caught:
        checkpoint.load(tmp_path, learner_of(1), "abc", 3)
    assert str(path) in str(caught.value)


@pytest.mark.parametrize(
    "metadata", [None, {}, {"progress": "{"}, {"progress": json.dumps({"segments": 1})}]
)
def test_what_is_no_checkpoint_is_refused(tmp_path, metadata):
    (tmp_path / checkpoint.FILE).write_bytes(save(tensors_of(), metadata))
    with pytest.raises(StoreError, match="must be a complete checkpoint"):
        checkpoint.load(tmp_path, learner_of(1), "abc", 3)


def test_a_weight_without_two_axes_is_refused(path):
    write_weights(path, {**tensors_of(), "output.weight": np.zeros(10, np.float32)}, ABOUT)
    assert "weights must have two axes" in refused(path)


@pytest.mark.parametrize("name", ["recurrent-ppo", "recurrent-ppo-plus"])
def test_three_trainings_of_an_entry_ship_and_have_the_recipe_that_ships(name):
    paths = [SHIPPED / f"{name}.safetensors", *SHIPPED.glob(f"{name}-seed-?.safetensors")]
    abouts = [read_weights(path)[1] for path in paths]
    assert sorted(about["progress"]["seed"] for about in abouts) == [0, 1, 2]
    for path, about in zip(paths[1:], abouts[1:], strict=True):
        assert path.stem == f"{name}-seed-{about['progress']['seed']}"
    recipe = yaml.safe_load(
        (RecurrentPPOTrainer.recipes / f"{abouts[0]['recipe']}.yaml").read_text("utf-8")
    )
    assert {about["recipe_hash"] for about in abouts} == {Recipe(**recipe).hash}


def test_weights_in_half_precision_are_read_as_what_they_hold(tmp_path):
    half = include(SHIPPED / "recurrent-ppo.safetensors", "recurrent-ppo", tmp_path)
    seed = read_weights(SHIPPED / "recurrent-ppo.safetensors")[1]["progress"]["seed"]
    assert half.name == f"recurrent-ppo-seed-{seed}.safetensors"
    assert half.stat().st_size < 0.51 * (SHIPPED / "recurrent-ppo.safetensors").stat().st_size
    (whole, about), (found, same) = (
        read_weights(path) for path in (SHIPPED / "recurrent-ppo.safetensors", half)
    )
    assert about.pop("sha256") != same.pop("sha256")
    assert about == same
    for one, other in zip(whole.layers, found.layers, strict=True):
        assert other.weight.dtype == np.float32
        np.testing.assert_array_equal(one.weight.astype(np.float16), other.weight)
