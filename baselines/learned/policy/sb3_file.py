"""Read the policy in a file that `model.save` of Stable-Baselines3 or sb3-contrib wrote.

Only the parameters (`policy.pth`) and the plain parts of `data`, which is JSON, are read. Pickled
objects in `data` are skipped, so a file of a stranger can do no harm.
"""

import io
import json
import re
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from benchnav.arrays import AnyArray

from .torch_file import member, read_torch_tensors

_NUMBER = re.compile(r"[-+]?\d+\.?\d*(?:e[-+]?\d+)?")
_CLASS = re.compile(r"<class '.*?(\w+)'>")
_ACTIVATIONS = {"Tanh": "tanh", "ReLU": "relu", "LeakyReLU": "leaky-relu", "ELU": "elu",
                "SiLU": "silu"}  # fmt: skip
_EXTRACTOR = re.compile(r"(?:actor\.|pi_)?features_extractor\.")


@dataclass(frozen=True, eq=False)
class SavedPolicy:
    """The actor of a policy, and what the file says about it."""

    tensors: Mapping[str, AnyArray]  # in the format of `Actor`
    activation: str  # a name of `ACTIVATIONS`, or the class of another one
    squash: bool  # a hyperbolic tangent limits the actions
    low: tuple[float, ...] | None  # of the action space; None: unknown
    high: tuple[float, ...] | None
    decisions: int  # of the training, idle ones included


@dataclass(frozen=True)
class _Layout:
    """The names of the layers of one family of algorithms."""

    output: str  # last layer, or the sequence of layers whose last one it is
    dense: str  # layers before it
    activation: str  # the default
    squash: bool


_ON_POLICY = _Layout("action_net", "mlp_extractor.policy_net", "tanh", False)
_GAUSSIAN = _Layout("actor.mu", "actor.latent_pi", "relu", True)
_DETERMINISTIC = _Layout("actor.mu", "actor.mu", "relu", True)


def read_sb3_policy(data: bytes) -> SavedPolicy:
    """Return the policy in a file of `model.save`.

    Raises ValueError with a reason, or another error if the content is damaged.
    """
    archive = zipfile.ZipFile(io.BytesIO(data))
    if "policy.pth" not in archive.namelist():
        raise ValueError(_no_policy(archive.namelist()))
    tensors = read_torch_tensors(member(archive, "policy.pth"))
    about = json.loads(member(archive, "data")) if "data" in archive.namelist() else {}
    options = _mapping(about, "policy_kwargs")
    layout = _layout(tensors)
    space = _mapping(about, "action_space")
    decisions = about.get("num_timesteps", 0)
    return SavedPolicy(
        _actor_tensors(tensors, layout),
        _activation(options, layout.activation),
        layout.squash or options.get("squash_output") is True,
        _numbers(space.get("low")),
        _numbers(space.get("high")),
        decisions if isinstance(decisions, int) else 0,
    )


def _no_policy(names: list[str]) -> str:
    if any(name.endswith("/data.pkl") for name in names):
        return "it is a file of torch.save; give the file that `model.save` wrote"
    return f"it has no policy.pth; it holds {', '.join(names[:5]) or 'nothing'}"


def _mapping(about: Any, key: str) -> dict[str, Any]:
    value = about.get(key) if isinstance(about, dict) else None
    return value if isinstance(value, dict) else {}


def _numbers(text: Any) -> tuple[float, ...] | None:
    found = tuple(
        float(number) for number in _NUMBER.findall(text if isinstance(text, str) else "")
    )
    return found or None


def _activation(options: Mapping[str, Any], default: str) -> str:
    text = options.get("activation_fn")
    if text is None:
        return default
    found = _CLASS.search(str(text))
    name = found[1] if found else str(text)[:80]
    return _ACTIVATIONS.get(name, name)


def _layout(tensors: Mapping[str, AnyArray]) -> _Layout:
    if any(_EXTRACTOR.match(name) for name in tensors):
        raise ValueError(
            "its policy has a feature extractor with weights; MlpPolicy and MlpLstmPolicy are"
            " supported"
        )
    if "action_net.weight" in tensors:
        return _ON_POLICY
    if "actor.mu.weight" in tensors:
        return _GAUSSIAN
    if "actor.latent_pi.0.weight" in tensors and "actor.mu.0.weight" in tensors:
        raise ValueError("it was trained with use_sde; SAC is supported without it")
    if "actor.mu.0.weight" in tensors:
        return _DETERMINISTIC
    if any(name.startswith("q_net.") for name in tensors):
        raise ValueError("its actions are choices; a policy must give two numbers")
    raise ValueError(
        "its layers are those of no supported algorithm: PPO, A2C, TRPO, RecurrentPPO, SAC, TQC,"
        f" TD3, DDPG. It holds {', '.join([*tensors][:3])}, …"
    )


def _actor_tensors(tensors: Mapping[str, AnyArray], layout: _Layout) -> dict[str, AnyArray]:
    """Return the layers of the actor in the format of `Actor`."""
    found: dict[str, AnyArray] = {}
    for k in range(sum(name.startswith("lstm_actor.weight_ih_l") for name in tensors)):
        part = {name: tensors[f"lstm_actor.{name}_l{k}"] for name in
                ("weight_ih", "weight_hh", "bias_ih", "bias_hh")}  # fmt: skip
        found[f"lstm{k}.weight"] = np.concatenate([part["weight_ih"], part["weight_hh"]], axis=1).T
        found[f"lstm{k}.bias"] = part["bias_ih"] + part["bias_hh"]
    layers = _sequence(tensors, layout.dense)
    output = layers.pop() if layout.output == layout.dense else layout.output
    for name, layer in [*((f"dense{k}", layer) for k, layer in enumerate(layers)),
                        ("output", output)]:  # fmt: skip
        found[f"{name}.weight"] = tensors[f"{layer}.weight"].T
        found[f"{name}.bias"] = tensors[f"{layer}.bias"]
    return {name: np.ascontiguousarray(tensor, np.float32) for name, tensor in found.items()}


def _sequence(tensors: Mapping[str, AnyArray], prefix: str) -> list[str]:
    """Return the names of the layers of a torch Sequential, which must be dense."""
    own = [name for name in tensors if name.startswith(f"{prefix}.")]
    layers = sorted({int(name.removeprefix(prefix).split(".")[1]) for name in own})
    for k in layers:
        parts = {name.removeprefix(f"{prefix}.{k}.") for name in own if f"{prefix}.{k}." in name}
        weight = tensors.get(f"{prefix}.{k}.weight")
        if parts != {"weight", "bias"} or weight is None or weight.ndim != 2:
            raise ValueError(f"its layer {prefix}.{k} is not a dense layer with a bias")
    return [f"{prefix}.{k}" for k in layers]
