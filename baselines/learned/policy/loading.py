"""Make a policy from its file, the YAML file beside it, and the parameters of the navigator."""

import hashlib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

import numpy as np
from pydantic import Field

from benchnav.arrays import FloatArray
from benchnav.envs import ENCODERS, Encoder, encoder
from benchnav.errors import BenchnavError, PluginError, UsageError, did_you_mean
from benchnav.navigation import PluginConfig, Training

from ...common.tensor_file import content_of
from ..recurrent_ppo.actor import Actor
from .facts import Box, facts_beside
from .network import ACTIVATIONS, ActorNetwork, Network
from .onnx_file import OnnxNetwork
from .sb3_file import SavedPolicy, read_sb3_policy
from .torch_file import MAX_BYTES

T = TypeVar("T")
_ZIP = b"PK\x03\x04"


class PolicyConfig(PluginConfig):
    """Parameters. Those that are left out are those of the YAML file beside the policy.

    That file has the name of the policy and the ending `.yaml`. Values that it leaves out, too, are
    derived from the policy if possible.
    """

    file: str = Field(
        min_length=1,
        description="`.zip` of Stable-Baselines3 or sb3-contrib, or `.onnx`",
    )
    encoder: str = Field("", description=f"encoder that it was trained with: {', '.join(ENCODERS)}")
    activation: str = Field(
        "", description=f"activation of the dense layers of a `.zip`: {', '.join(ACTIVATIONS)}"
    )
    low: Box | None = Field(None, description="least values of its actions: [speed, turn rate]")
    high: Box | None = Field(None, description="greatest values of its actions")


@dataclass(frozen=True, eq=False)
class Policy:
    """A policy that is ready to decide."""

    network: Network
    encoder: Encoder
    low: FloatArray  # (2,) of the actions
    high: FloatArray
    training: Training | None  # None if the files do not state its cost
    sha256: str  # of its file and of the YAML file

    def actions(self, x: np.ndarray, state: np.ndarray) -> FloatArray:
        """Return (N, 2) in [-1, 1], as the environments take them; see `Network.decide`."""
        action = np.clip(self.network.decide(x, state).astype(np.float64), self.low, self.high)
        middle, half = 0.5 * (self.low + self.high), 0.5 * (self.high - self.low)
        scaled: FloatArray = (action - middle) / half
        return scaled


def load_policy(config: PolicyConfig) -> Policy:
    """Return the policy that a configuration names.

    Raises PluginError for a file that is no policy, ScenarioError for a mistake in the YAML file,
    and MissingExtraError if ONNX Runtime is missing.
    """
    path = Path(config.file)
    facts, beside = facts_beside(path)
    data = content_of(path, MAX_BYTES)
    low, high = config.low or facts.low, config.high or facts.high
    decisions = facts.decisions
    network: Network
    if data.startswith(_ZIP):
        saved = _read(path, "a complete file of `model.save`", read_sb3_policy, data)
        network = _network(path, saved, config.activation or facts.activation)
        decisions = decisions or saved.decisions
        if saved.squash:  # the library scales its actions from -1 … 1 to the action space
            low, high = (-1.0, -1.0), (1.0, 1.0)
        else:
            low, high = low or _pair(saved.low), high or _pair(saved.high)
    elif path.suffix.lower() == ".onnx":
        network = _read(path, "an ONNX file of a policy", OnnxNetwork, data)
    else:
        raise PluginError(
            f"{path}: must be a .zip of Stable-Baselines3 or an .onnx file. It is something else."
            f"{_hint(path)}"
        )
    box = np.array([low or (-1.0, -1.0), high or (1.0, 1.0)])
    if not (box[0] < box[1]).all():
        raise PluginError(f"{path}: low must be below high. Got {box[0]} and {box[1]} instead.")
    chosen = _encoder(path, config.encoder or facts.encoder, network.inputs)
    digest = hashlib.sha256(hashlib.sha256(data).digest() + beside).hexdigest()
    training = Training(decisions, facts.seconds) if decisions else None
    return Policy(network, chosen, box[0], box[1], training, digest)


def _read(path: Path, kind: str, reader: Callable[[bytes], T], data: bytes) -> T:
    try:
        return reader(data)
    except BenchnavError:
        raise
    except Exception as error:  # of damaged content, libraries raise whatever they like
        reason = " ".join(str(error).split())[:300].rstrip(".")
        reason = reason if type(error) is ValueError else f"it is damaged: {reason}"
        raise PluginError(f"{path}: must be {kind}: {reason}.") from None


def _network(path: Path, saved: SavedPolicy, activation: str) -> Network:
    name = activation or saved.activation
    if name not in ACTIVATIONS:
        raise PluginError(
            f"{path}: the activation must be one of {', '.join(ACTIVATIONS)}. Got {name!r}"
            f" instead.{did_you_mean(name, ACTIVATIONS)}"
        )
    actor = Actor(saved.tensors, ACTIVATIONS[name])
    _check_layers(path, actor)
    return ActorNetwork(actor, saved.squash)


def _check_layers(path: Path, actor: Actor) -> None:
    """Refuse layers that do not fit each other: a kernel would read beyond them."""
    width = None
    for k, layer in enumerate(actor.layers):
        recurrent = k < len(actor.lstm)
        outputs = len(layer.bias) // 4 if recurrent else len(layer.bias)
        inputs = len(layer.weight) - (outputs if recurrent else 0)
        fits = layer.weight.shape[1] == len(layer.bias) and inputs > 0 and layer.bias.ndim == 1
        if not fits or (width is not None and inputs != width):
            raise PluginError(f"{path}: the layers of its policy do not fit each other.")
        if not (np.isfinite(layer.weight).all() and np.isfinite(layer.bias).all()):
            raise PluginError(f"{path}: its weights must be finite. They hold NaN or infinity.")
        width = outputs
    if width != 2:
        raise PluginError(
            f"{path}: its policy must have 2 actions: speed and turn rate. It has {width}."
        )


def _encoder(path: Path, name: str, inputs: int) -> Encoder:
    fitting = [each for each in ENCODERS if encoder(each).size == inputs]
    fit = f"Encoders with {inputs} values: {', '.join(fitting) or 'none'}."
    if not name and len(fitting) == 1:
        return encoder(fitting[0])
    if not name:
        raise PluginError(
            f"{path}: the encoder of its training must be given: encoder: NAME, as a parameter or"
            f" in {path.with_suffix('.yaml')}. {fit}"
        )
    try:
        chosen = encoder(name)
    except UsageError as error:
        raise PluginError(f"{path}: {error}") from None
    if chosen.size != inputs:
        raise PluginError(
            f"{path}: its observation must have {chosen.size} values for the encoder {name!r}."
            f" It has {inputs}. {fit}"
        )
    return chosen


def _pair(limits: tuple[float, ...] | None) -> tuple[float, float] | None:
    return (limits[0], limits[1]) if limits is not None and len(limits) == 2 else None


def _hint(path: Path) -> str:
    if path.suffix == ".safetensors":
        return " Weights of a trainer are for its own navigator: {type: recurrent-ppo, weights: …}."
    return ""
