"""Policies of Stable-Baselines3 and sb3-contrib drive as their libraries do, and no pickle runs."""

import base64
import io
import json
import pickle
import zipfile

import numpy as np
import pytest
import torch
from benchnav_baselines.learned.policy.loading import PolicyConfig, load_policy
from benchnav_baselines.learned.policy.torch_file import read_torch_tensors

from benchnav.errors import BenchnavError, PluginError, ScenarioError
from benchnav.navigation.plugin.configure import make
from benchnav.plugins import NAVIGATORS
from benchnav.testing.check_navigator import check_navigator
from tests.baselines.policies import answers, driven, learner, observations

ALGORITHMS = ("PPO", "A2C", "TRPO", "SAC", "TQC", "TD3", "DDPG", "RecurrentPPO")


def loaded(path, **parameters):
    return load_policy(PolicyConfig(file=str(path), **{"encoder": "ego", **parameters}))


@pytest.fixture(scope="module")
def ppo(tmp_path_factory):
    path = tmp_path_factory.mktemp("policies") / "ppo.zip"
    learner("PPO").save(path)
    return path


def changed(source, target, **members):
    """A copy of a zip file with other members; None removes one."""
    with zipfile.ZipFile(source) as old, zipfile.ZipFile(target, "w") as new:
        for name in old.namelist():
            content = members.get(name, old.read(name))
            if content is not None:
                new.writestr(name, content)
    return target


@pytest.mark.parametrize("name", ALGORITHMS)
def test_a_policy_acts_as_its_library_does(tmp_path, name):
    made, seen = learner(name), observations()
    made.save(tmp_path / "policy.zip")
    policy = loaded(tmp_path / "policy.zip")
    expected = answers(made, seen)
    np.testing.assert_allclose(driven(policy, seen), expected, atol=2e-6)
    assert np.ptp(expected) > 0.1
    assert policy.network.state_size == (32 if name == "RecurrentPPO" else 0)


@pytest.mark.parametrize("activation", ["ReLU", "ELU", "LeakyReLU", "SiLU", "Tanh"])
def test_the_activation_is_read_from_the_file(tmp_path, activation):
    made = learner("PPO", policy_kwargs={"activation_fn": getattr(torch.nn, activation)})
    made.save(tmp_path / "policy.zip")
    seen = observations()
    np.testing.assert_allclose(
        driven(loaded(tmp_path / "policy.zip"), seen), answers(made, seen), atol=2e-6
    )


def test_tensors_are_those_that_torch_reads(ppo):
    data = zipfile.ZipFile(ppo).read("policy.pth")
    mine, torchs = read_torch_tensors(data), torch.load(io.BytesIO(data), weights_only=True)
    assert mine.keys() == torchs.keys()
    for name, tensor in torchs.items():
        np.testing.assert_array_equal(mine[name], tensor.numpy(), err_msg=name)


def test_actions_of_another_box_are_scaled_to_the_environments(ppo, tmp_path):
    """As in an environment with gymnasium.wrappers.RescaleAction(env, 0, 4)."""
    seen = observations()
    plain = learner("PPO").policy
    data = json.loads(zipfile.ZipFile(ppo).read("data"))
    data["action_space"] |= {"low": "[0. 0.]", "high": "[4. 4.]"}
    path = changed(ppo, tmp_path / "scaled.zip", data=json.dumps(data))
    with torch.no_grad():
        raw = np.array([plain._predict(torch.as_tensor(x), True).numpy() for x in seen])
    expected = np.clip(raw, 0.0, 4.0) / 2.0 - 1.0
    np.testing.assert_allclose(driven(loaded(path), seen), expected, atol=2e-6)
    given = loaded(ppo, low=(0.0, 0.0), high=(4.0, 4.0))
    np.testing.assert_allclose(driven(given, seen), expected, atol=2e-6)


def test_a_yaml_file_beside_it_completes_the_policy(ppo, tmp_path):
    path = changed(ppo, tmp_path / "mine.zip")
    bare = loaded(path)
    assert bare.training is None
    path.with_suffix(".yaml").write_text("encoder: ego\ndecisions: 500\nseconds: 2.5\n")
    spec = {"type": "policy", "file": str(path)}
    navigator = make(NAVIGATORS, spec)
    assert (navigator.training.decisions, navigator.training.seconds) == (500, 2.5)
    assert navigator.fingerprint != bare.sha256  # it depends on both files
    path.with_suffix(".yaml").write_text("encoder: ego\nlayers: 3\n")
    with pytest.raises(ScenarioError, match=r"mine\.yaml:2.*layers"):
        make(NAVIGATORS, spec)


@pytest.mark.parametrize("name", ["PPO", "RecurrentPPO", "SAC"])
def test_it_keeps_the_contract_of_navigators(tmp_path, name):
    learner(name).save(tmp_path / "policy.zip")
    check_navigator({"type": "policy", "file": str(tmp_path / "policy.zip"), "encoder": "ego"})


class Bomb:
    def __init__(self, mark):
        self.mark = mark

    def __reduce__(self):
        return (open, (str(self.mark), "w"))


def test_a_pickle_bomb_does_nothing(ppo, tmp_path):
    """Neither among the tensors nor among the pickled objects of the library."""
    mark = tmp_path / "exploded"
    inner = io.BytesIO()
    with zipfile.ZipFile(inner, "w") as archive:
        archive.writestr("archive/data.pkl", pickle.dumps({"x": Bomb(mark)}, protocol=2))
    path = changed(ppo, tmp_path / "bomb.zip", **{"policy.pth": inner.getvalue()})
    with pytest.raises(PluginError, match="tensors need no call of") as refused:
        loaded(path)
    assert str(path) in str(refused.value)
    data = json.loads(zipfile.ZipFile(ppo).read("data"))
    data["policy_class"][":serialized:"] = base64.b64encode(pickle.dumps(Bomb(mark))).decode()
    loaded(changed(ppo, tmp_path / "quiet.zip", data=json.dumps(data)))
    assert not mark.exists()


def other_observation(ppo, folder):
    path = folder / "surround.zip"
    learner("PPO", encoder="surround").save(path)
    return path


def three_actions(ppo, folder):
    return with_tensors(folder, {"action_net.weight": (3, 8), "action_net.bias": (3,)})


def broken_layers(ppo, folder):
    return with_tensors(folder, {"action_net.weight": (2, 9), "action_net.bias": (2,)})


def not_finite(ppo, folder):
    return with_tensors(folder, {"action_net.weight": (2, 8), "action_net.bias": (2,)}, np.nan)


def choices(ppo, folder):
    return with_tensors(folder, {"q_net.q_net.0.weight": (2, 62)}, alone=True)


def extractor(ppo, folder):
    return with_tensors(folder, {"features_extractor.cnn.0.weight": (2, 2)})


def with_tensors(folder, shapes, value=0.1, alone=False):
    state = {} if alone else learner("PPO").policy.state_dict()
    state |= {name: torch.full(shape, value) for name, shape in shapes.items()}
    saved = io.BytesIO()
    torch.save(state, saved)
    path = folder / "changed.zip"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("policy.pth", saved.getvalue())
    return path


def without_policy(ppo, folder):
    return changed(ppo, folder / "empty.zip", **{"policy.pth": None})


def of_torch(ppo, folder):
    path = folder / "state.pth"
    torch.save({"x": torch.zeros(2)}, path)
    return path


def truncated(ppo, folder):
    path = folder / "short.zip"
    path.write_bytes(ppo.read_bytes()[:5000])
    return path


def text(ppo, folder):
    path = folder / "policy.txt"
    path.write_text("hello")
    return path


def weights(ppo, folder):
    path = folder / "weights.safetensors"
    path.write_bytes(b"{}")
    return path


def a_folder(ppo, folder):
    return folder


def nothing(ppo, folder):
    return folder / "none.zip"


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (other_observation, "must have 62 values for the encoder 'ego'. It has 80. Encoders with"
                            " 80 values: surround."),
        (three_actions, "must have 2 actions: speed and turn rate. It has 3."),
        (broken_layers, "the layers of its policy do not fit each other."),
        (not_finite, "its weights must be finite."),
        (choices, "its actions are choices; a policy must give two numbers"),
        (extractor, "feature extractor with weights; MlpPolicy and MlpLstmPolicy are supported"),
        (without_policy, "must be a complete file of `model.save`: it has no policy.pth; it holds"),
        (of_torch, "it is a file of torch.save; give the file that `model.save` wrote"),
        (truncated, "it is damaged: File is not a zip file"),
        (text, "must be a .zip of Stable-Baselines3 or an .onnx file. It is something else."),
        (weights, "{type: recurrent-ppo, weights: …}"),
        (a_folder, "cannot be read: it must be a file, and is a folder."),
        (nothing, "cannot be read: No such file or directory."),
    ],
)  # fmt: skip
def test_a_file_that_does_not_fit_is_explained(ppo, tmp_path, given, message):
    path = given(ppo, tmp_path)
    with pytest.raises(PluginError) as refused:
        loaded(path)
    assert str(refused.value).startswith(str(path))
    assert message in str(refused.value)


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"encoder": ""}, "Encoders with 62 values: paper, ego, near."),
        ({"encoder": "egoo"}, "Did you mean 'ego'?"),
        ({"activation": "rellu"}, "Did you mean 'relu' or 'elu'?"),
        ({"low": (1.0, 1.0)}, "low must be below high."),
    ],
)
def test_a_parameter_that_does_not_fit_is_explained(ppo, parameters, message):
    with pytest.raises(BenchnavError) as refused:
        loaded(ppo, **parameters)
    assert message in str(refused.value)


def test_the_encoder_may_be_left_out_if_only_one_fits(ppo, tmp_path):
    path = other_observation(ppo, tmp_path)
    assert loaded(path, encoder="").encoder.name == "surround"
