"""Training from a recipe: the same bits again, also after a stop, and no bad recipe begins."""

import csv
import json
from dataclasses import replace
from multiprocessing import active_children

import numpy as np
import pytest
import torch
import yaml
from benchnav_baselines.learned.recurrent_ppo.learning import checkpoint, segments
from benchnav_baselines.learned.recurrent_ppo.learning.courses import (
    training_pools,
    validation_batches,
)
from benchnav_baselines.learned.recurrent_ppo.learning.recipe import Course, Recipe
from benchnav_baselines.learned.recurrent_ppo.learning.segments import WEIGHTS, Training
from benchnav_baselines.learned.recurrent_ppo.weights import read_weights
from safetensors import safe_open
from safetensors.numpy import load_file

from benchnav.cli.main import status
from benchnav.errors import TrainingError, UsageError

TINY = """\
name: tiny
encoder: ego
courses: [{scenario: leaders/static, worlds: 4}]
rows: 2
rollout: 16
sequence: 8
network: {lstm_layers: 1, lstm_size: 8}
stages:
  - {decisions: 300, learning_rate: [1.0e-3, 1.0e-4], batch: 32, epochs: 1}
  - {decisions: 150, batch: 32, epochs: 1, log_std: [-0.5, -1.0]}
checkpoint: 150
validation: {worlds: 1}
trainer: recurrent-ppo
"""


def tiny(**changes):
    return Recipe.model_validate({**yaml.safe_load(TINY), **changes})


class Killed(Exception):
    pass


def killer(after):
    """A report callback that ends the process after so many checkpoints."""
    seen = []

    def report(now):
        if now.success is not None:
            seen.append(now)
        if len(seen) == after and now is not seen[-1]:
            raise Killed

    return report


def silent(_):
    pass


def contents(folder):
    """Every number that a training left, but seconds."""
    tensors = load_file(folder / WEIGHTS) | load_file(folder / checkpoint.FILE)
    with safe_open(folder / checkpoint.FILE, framework="np") as file:
        progress = json.loads(file.metadata()["progress"])
    about = read_weights(folder / WEIGHTS)[1]
    with (folder / "curve.csv").open() as file:
        rows = [{k: float(v) for k, v in row.items()} for row in csv.DictReader(file)]
    del about["sha256"]  # of the file, seconds included
    for part in (progress, about["progress"], *rows):
        del part["seconds"]
    return tensors, (progress, about, rows)


def assert_same(one, other):
    (tensors, rest), (others, others_rest) = contents(one), contents(other)
    assert rest == others_rest
    assert tensors.keys() == others.keys()
    for name, tensor in tensors.items():
        np.testing.assert_array_equal(tensor, others[name], err_msg=name)


@pytest.mark.slow
@pytest.mark.parametrize("network", [{"lstm_layers": 1, "lstm_size": 8},
                                     {"lstm_layers": 0, "dense": [8]}])  # fmt: skip
def test_a_training_is_its_recipe_and_seed(tmp_path, network):
    recipe = tiny(network=network)
    Training(recipe, 1, tmp_path / "whole").run(False, silent)
    Training(recipe, 1, tmp_path / "again").run(False, silent)
    assert_same(tmp_path / "whole", tmp_path / "again")
    with pytest.raises(Killed):
        Training(recipe, 1, tmp_path / "broken").run(False, killer(after=1))
    Training(recipe, 1, tmp_path / "broken").run(True, silent)
    assert_same(tmp_path / "whole", tmp_path / "broken")
    Training(recipe, 2, tmp_path / "other").run(False, silent)
    mine, others = (contents(tmp_path / name)[0] for name in ("whole", "other"))
    assert any((mine[name] != others[name]).any() for name in mine)
    _, (progress, about, rows) = contents(tmp_path / "whole")
    assert progress["stage"] == 2
    assert len(rows) == progress["segment"] >= 3
    assert about["recipe_hash"] == recipe.hash
    with pytest.raises(UsageError, match="holds a training"):
        Training(recipe, 1, tmp_path / "whole").run(False, silent)


@pytest.mark.slow
@pytest.mark.parametrize("changes", [{"precision": "bfloat16"}, {"processes": 2}])
def test_every_option_can_be_resumed(tmp_path, changes):
    recipe = tiny(**changes)
    Training(recipe, 1, tmp_path / "whole").run(False, silent)
    with pytest.raises(Killed):
        Training(recipe, 1, tmp_path / "broken").run(False, killer(after=1))
    assert not active_children()
    Training(recipe, 1, tmp_path / "broken").run(True, silent)
    assert_same(tmp_path / "whole", tmp_path / "broken")


@pytest.mark.slow
def test_a_process_that_is_killed_ends_the_training(tmp_path):
    def report(now):
        for process in active_children():
            process.kill()

    with pytest.raises(TrainingError, match=r"learner 1 was killed by SIGKILL .* resume"):
        Training(tiny(processes=2), 0, tmp_path).run(False, report)
    assert (tmp_path / checkpoint.FILE).exists()
    assert not active_children()


def test_a_resumed_training_keeps_its_precision(tmp_path, monkeypatch):
    monkeypatch.setattr(segments, "native_precision", lambda _: "bfloat16")
    for resume in (False, True):
        training = Training(tiny(), 0, tmp_path)
        training._begin(resume)
        assert training.learner.policy.half_products
        monkeypatch.setattr(segments, "native_precision", lambda _: "float32")


@pytest.mark.skipif(not torch.cuda.is_available(), reason="there is no CUDA device")
@pytest.mark.parametrize("precision", ["float32", "bfloat16"])
def test_a_device_trains(tmp_path, precision):
    training = Training(tiny(precision=precision), 0, tmp_path, "cuda")
    training.run(False, silent)
    assert training.learner.device.type == "cuda"
    read_weights(tmp_path / WEIGHTS)


@pytest.mark.slow
@pytest.mark.parametrize("layers", [0, 1])
def test_a_stage_may_have_another_number_of_slots(tmp_path, layers):
    """Four leaders in each row, then one robot whose people are driven by the scenario."""
    first, last = tiny().stages
    crowd = (Course(scenario="crowd/circle-crossing", worlds=3),)
    recipe = tiny(
        stages=[first, last.model_copy(update={"courses": crowd})],
        network={"lstm_layers": layers, "lstm_size": 8, "dense": [8]},
    )
    whole = Training(recipe, 1, tmp_path / "whole")
    whole.run(False, silent)
    assert whole.learner.n_envs == whole.learner.rollout_buffer.n_envs == 2
    with pytest.raises(Killed):
        Training(recipe, 1, tmp_path / "broken").run(False, killer(after=2))
    Training(recipe, 1, tmp_path / "broken").run(True, silent)
    assert_same(tmp_path / "whole", tmp_path / "broken")


def poison(learner):
    with torch.no_grad():
        next(learner.policy.parameters())[0] = float("nan")


@pytest.mark.slow
@pytest.mark.parametrize("when", ["by the last update", "before the rollout"])
def test_numbers_that_are_not_finite_end_it_and_the_checkpoint_stays(tmp_path, when):
    training, kept = Training(tiny(), 0, tmp_path), []

    def report(now):
        if now.success is None or kept:
            return
        kept.append((tmp_path / checkpoint.FILE).read_bytes())
        if when == "before the rollout":
            poison(training.learner)
        else:
            training.learner.train = lambda: poison(training.learner)

    with pytest.raises(TrainingError, match="must stay finite") as caught:
        training.run(False, report)
    assert str(tmp_path) in str(caught.value)
    assert (tmp_path / checkpoint.FILE).read_bytes() == kept[0]
    read_weights(tmp_path / WEIGHTS)


def test_patience_counts_checkpoints_without_a_better_one():
    training = Training(tiny(patience=2), 0, None)
    progress = checkpoint.Progress("", 0)
    for reached, waited in [(0.5, 0), (0.5, 1), (0.6, 0), (0.1, 1)]:
        progress = training._after(progress, 10, reached)
        assert (progress.stage, progress.waited) == (0, waited)
    progress = training._after(progress, 10, 0.6)
    assert (progress.stage, progress.in_stage, progress.best, progress.waited) == (1, 0, -1.0, 0)
    assert (progress.decisions, progress.segment) == (50, 5)
    done = training._after(replace(progress, in_stage=149), 1, 0.0)
    assert done.stage == 2


def test_the_hash_is_of_what_decides_the_weights():
    recipe = tiny()
    assert recipe.hash == tiny(description="other words").hash
    defaults = {"perception": "exact", "precision": "auto", "processes": 1, "hidden_movers": False}
    assert recipe.hash == tiny(**defaults).hash
    others = [
        tiny(rows=3), tiny(gamma=0.9), tiny(encoder="paper"), tiny(sequence=7),
        tiny(precision="float32"), tiny(processes=2), tiny(perception="noisy"),
        tiny(network={"lstm_layers": 1, "lstm_size": 9}), tiny(encoder="surround"),
        tiny(encoder="surround", hidden_movers=True),
    ]  # fmt: skip
    assert len({recipe.hash, *(other.hash for other in others)}) == 11


def test_hidden_movers_and_foresight_exclude_each_other():
    stages = [{"decisions": 100, "batch": 32, "foresight": True}]
    tiny(encoder="surround", stages=stages)
    with pytest.raises(ValueError, match="must be false with hidden_movers: true"):
        tiny(encoder="surround", stages=stages, hidden_movers=True)


def test_a_recipe_trains_and_validates_in_its_perception_track():
    for perception, noisy in (("exact", False), ("noisy", True)):
        recipe = tiny(perception=perception)
        (pool,) = training_pools(recipe, recipe.stages[0])
        assert (pool.noise is not None) is noisy
        (batch,) = validation_batches(recipe).values()
        assert (batch._senses is not None) is noisy


@pytest.fixture
def call(capfd, tmp_path):
    """A recipe's text and options → (exit status, stderr) of `benchnav train`."""

    def call(text, *options):
        path = tmp_path / "recipe.yaml"
        path.write_text(text)
        code = status(["train", str(path), "--out", str(tmp_path / "out"), *map(str, options)])
        out, said = capfd.readouterr()
        assert "Traceback" not in said
        if code:
            assert out == ""
        return code, said

    return call


@pytest.mark.parametrize(
    ("old", "new", "complaint"),
    [
        ("rows: 2", "rowz: 2", "recipe.yaml:4: rowz is not a known key. Did you mean 'rows'?"),
        ("rows: 2", "rows: 0", "recipe.yaml:4: rows must be ≥ 1; got 0."),
        ("rows: 2", "rows: two", "recipe.yaml:4: rows must be a whole number; got 'two'."),
        ("rows: 2", "gamma: 1.5", "recipe.yaml:4: gamma must be ≤ 1"),
        ("encoder: ego", "encoder: eggo", "recipe.yaml:2: encoder must be one of paper"),
        ("encoder: ego", "encoder: eggo", "Did you mean 'ego'?"),
        ("trainer: recurrent-ppo", "trainer: ppo", "recipe.yaml:13: trainer must be one of"),
        ("trainer: recurrent-ppo", "", "recipe.yaml:1: the key 'trainer' is missing"),
        ("trainer: recurrent-ppo", "", "Add the line 'trainer: NAME' with one of these names: "),
        ("trainer:", "trainr:", "Or rename the key 'trainr'."),
        ("name: tiny", "name: Big Name", "recipe.yaml:1: name must match"),
        ("worlds: 4", "world: 4", "recipe.yaml:3: courses[0].world is not a known key"),
        ("batch: 32, epochs: 1}\n  -", "batch: 8}\n  -", "recipe.yaml:9: stages[0].batch must be"),
        ("epochs: 1, log_std: [-0.5, -1.0]}", "reward: {wall: 1}}",
         "recipe.yaml:10: stages[1].reward.wall is not a known key. Did you mean 'walls'?"),
        ("lstm_layers: 1", "lstm_layers: 0", "recipe.yaml:7: network must have LSTM or dense"),
        ("leaders/static", "leaders/statik", "leaders/static"),
        ("rows: 2", "hidden_movers: true\nrows: 2",
         "recipe.yaml:4: hidden_movers must be false with the encoder 'ego'"),
        ("rows: 2", "processes: 3\nrows: 2", "recipe.yaml:4: processes must be at most rows"),
    ],
)  # fmt: skip
def test_a_wrong_recipe_is_corrected_before_anything_begins(call, tmp_path, old, new, complaint):
    assert old in TINY
    code, said = call(TINY.replace(old, new, 1))
    assert code == 2
    assert complaint in said
    assert not (tmp_path / "out" / WEIGHTS).exists()


def test_options_that_cannot_be_followed_are_refused(call):
    assert call(TINY, "--resume")[0] == 2
    code, said = call(TINY, "--device", "abacus")
    assert code == 2
    assert "The device must be one of" in said
    code, said = call(TINY, "--processes", 3)
    assert code == 2
    assert "processes must be at most rows, which is 2; got 3" in said
    assert status(["train", "dynamik"]) == 2


def test_another_recipe_s_or_seed_s_training_is_not_gone_on_with(call, tmp_path):
    recipe, out = tiny(), tmp_path / "out"
    with pytest.raises(Killed):
        Training(recipe, 0, out).run(False, _at_once)
    for text, options in [(TINY.replace("rows: 2", "rows: 3"), ()), (TINY, ("--seed", 1))]:
        code, said = call(text, "--resume", *options)
        assert code == 2
        assert f"holds the training of recipe {recipe.hash} with seed 0" in said
    code, said = call(TINY)
    assert code == 2
    assert "must be new or empty" in said


def _at_once(_):
    raise Killed


@pytest.mark.slow
def test_the_command_trains_weights_that_run(call, tmp_path):
    code, _ = call(TINY, "--quiet")
    assert code == 0
    out = tmp_path / "out"
    actor, about = read_weights(out / WEIGHTS)
    assert about["encoder"] == "ego"
    assert actor.state_size == 16
    said = json.loads((out / "training.json").read_text())
    assert said["hash"] == Recipe.model_validate(yaml.safe_load(TINY)).hash
    assert Recipe.model_validate(said["recipe"]) == tiny()
