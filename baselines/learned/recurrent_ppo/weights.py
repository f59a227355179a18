"""Weights on disk: safetensors with the data needed to use and judge them; no pickle."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from benchnav.envs import ENCODERS, encoder
from benchnav.errors import PluginError

from ...common.tensor_file import read_tensors, write_tensors
from .actor import Actor, Float32Array
from .sightings import NEEDS

FORMAT = "benchnav-actor-1"


def write_weights(path: Path, tensors: Mapping[str, Float32Array], about: dict[str, Any]) -> None:
    """Write a file atomically. ``about`` holds plain data and must name the encoder."""
    arrays = {name: np.ascontiguousarray(tensor) for name, tensor in tensors.items()}
    write_tensors(path, arrays, {"format": FORMAT, **about})


def read_weights(path: Path) -> tuple[Actor, dict[str, Any]]:
    """Return the actor in a file, and the file's facts about it.

    Raises PluginError if the file is missing, truncated, foreign, or inconsistent.
    """
    file = read_tensors(path)
    about = {**file.about, "sha256": file.sha256}
    if about.get("format") != FORMAT:
        raise PluginError(
            f"{path}: must be weights written by `benchnav train` (format {FORMAT!r})."
            f" Got the format {about.get('format')!r} instead."
        )
    if not isinstance(about.get("progress"), dict):
        raise PluginError(
            f"{path}: must have the facts of its training (`progress`). They are missing."
        )
    name = about.get("encoder")
    if name not in ENCODERS:
        raise PluginError(f"{path}: made for the encoder {name!r}, which does not exist.")
    hidden = about.setdefault("hidden_movers", False)  # older files do not have the key
    if hidden is not False and not (hidden is True and encoder(name).needs >= NEEDS):
        raise PluginError(
            f"{path}: `hidden_movers` must be true or false, and may be true only with an encoder"
            f" of neighbours and edges. Got {hidden!r} with the encoder {name!r} instead."
        )
    actor = _fitting(path, _widened(file.tensors), encoder(name).size, name)
    return actor, about


def write_half(source: Path, target: Path) -> None:
    """Write the weights of one file to another as float16, in half the size."""
    file = read_tensors(source)
    half = {name: tensor.astype(np.float16) for name, tensor in file.tensors.items()}
    write_tensors(target, half, file.about)


def _widened(tensors: Mapping[str, Any]) -> dict[str, Any]:
    """Return float16 tensors as float32, which is exact, and others as they are."""
    return {
        name: tensor.astype(np.float32) if tensor.dtype == np.float16 else tensor
        for name, tensor in tensors.items()
    }


def _fitting(path: Path, tensors: Mapping[str, Float32Array], size: int, name: str) -> Actor:
    try:
        actor = Actor(tensors)
    except KeyError as error:
        raise PluginError(f"{path}: the tensor {error} must be there. It is not.") from None
    if any(layer.weight.ndim != 2 or layer.bias.ndim != 1 for layer in actor.layers):
        raise PluginError(f"{path}: weights must have two axes and biases one. They do not.")
    width = size
    for k, layer in enumerate(actor.lstm):
        hidden = len(layer.bias) // 4
        _demand(path, f"lstm{k}", layer.weight.shape, (width + hidden, len(layer.bias)), name)
        _demand(path, f"lstm{k}", layer.bias.shape, (4 * hidden,), name)
        width = hidden
    for layer_name, dense in [*((f"dense{k}", d) for k, d in enumerate(actor.dense)),
                        ("output", actor.output)]:  # fmt: skip
        _demand(path, layer_name, dense.weight.shape, (width, len(dense.bias)), name)
        width = len(dense.bias)
    _demand(path, "output", (width,), (2,), name)
    for key, tensor in tensors.items():
        if tensor.dtype != np.float32:
            raise PluginError(f"{path}: {key} must be float32. Got {tensor.dtype} instead.")
        if not np.isfinite(tensor).all():
            raise PluginError(f"{path}: {key} must be finite. It holds NaN or infinity.")
    return actor


def _demand(
    path: Path, layer_name: str, got: tuple[int, ...], want: tuple[int, ...], name: str
) -> None:
    if tuple(got) != want:
        raise PluginError(
            f"{path}: {layer_name} must have the shape {want} for the encoder {name!r}."
            f" Got {tuple(got)} instead."
        )
