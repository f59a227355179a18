"""Policies in ONNX files drive as those from which they were exported."""

import sys

import numpy as np
import pytest
from benchnav_baselines.learned.policy.loading import PolicyConfig, load_policy

from benchnav.errors import MissingExtraError, PluginError
from benchnav.testing.check_navigator import check_navigator
from tests.baselines.policies import driven, export, learner, observations

pytest.importorskip("onnxruntime", reason="needs the extra: pip install 'benchnav[onnx]'")
onnx = pytest.importorskip("onnx")


def loaded(path):
    return load_policy(PolicyConfig(file=str(path), encoder="ego"))


@pytest.mark.parametrize("name", ["PPO", "SAC", "RecurrentPPO"])
def test_an_exported_policy_gives_the_same_actions(tmp_path, name):
    made, seen = learner(name), observations()
    made.save(tmp_path / "policy.zip")
    export(made, tmp_path / "policy.onnx")
    exported = loaded(tmp_path / "policy.onnx")
    expected = driven(loaded(tmp_path / "policy.zip"), seen)
    np.testing.assert_allclose(driven(exported, seen), expected, atol=2e-6)
    alone = driven(exported, seen[:, 3:4])
    np.testing.assert_array_equal(alone, driven(exported, seen)[:, 3:4])
    check_navigator({"type": "policy", "file": str(tmp_path / "policy.onnx"), "encoder": "ego"})


def model(path, inputs, outputs, nodes):
    """Write a model; inputs and outputs are {name: shape}."""
    helper, number = onnx.helper, onnx.TensorProto.FLOAT

    def values(shapes):
        return [helper.make_tensor_value_info(n, number, s) for n, s in shapes.items()]

    graph = helper.make_graph(nodes, "policy", values(inputs), values(outputs))
    made = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=8)
    path.write_bytes(made.SerializeToString())
    return path


def same(source, target):
    return onnx.helper.make_node("Identity", [source], [target])


@pytest.mark.parametrize(
    ("inputs", "outputs", "message"),
    [
        ({"x": [62]}, {"y": [62]}, "must be the observation, of shape (1, D). Got the shape [62]"),
        ({"x": [1, 62]}, {"y": [1, 62]}, "must be the action, of shape (1, 2)"),
        ({"x": [1, 62], "h": [1, 4]}, {"y": [1, 62]}, "it must return as many new states; it"
                                                      " returns none"),
    ],
)  # fmt: skip
def test_a_model_with_another_interface_is_explained(tmp_path, inputs, outputs, message):
    path = model(tmp_path / "other.onnx", inputs, outputs, [same("x", "y")])
    with pytest.raises(PluginError) as refused:
        loaded(path)
    assert message in str(refused.value)


def test_a_damaged_file_is_explained(tmp_path):
    path = tmp_path / "broken.onnx"
    path.write_bytes(b"\x08\x07broken")
    with pytest.raises(PluginError, match=r"must be an ONNX file of a policy: it is damaged"):
        loaded(path)


def test_without_the_library_the_message_names_the_extra(tmp_path, monkeypatch):
    path = model(tmp_path / "fine.onnx", {"x": [1, 62]}, {"y": [1, 62]}, [same("x", "y")])
    monkeypatch.setitem(sys.modules, "onnxruntime", None)
    with pytest.raises(MissingExtraError, match=r"pip install 'benchnav\[onnx\]'"):
        loaded(path)
