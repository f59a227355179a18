"""Weights on disk: safetensors with what is needed to use and to judge them; no pickle."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from benchnav.envs.encoders.catalogue import ENCODERS, encoder
from benchnav.errors import PluginError

from ..tensor_file import read_tensors, write_tensors
from .actor import Actor, Float32Array

FORMAT = "benchnav-actor-1"


def write_weights(path: Path, tensors: Mapping[str, Float32Array], about: dict[str, Any]) -> None:
    """Atomically. ``about`` holds plain data and must name the encoder."""
    said = {"format": FORMAT, "about": json.dumps(about, sort_keys=True)}
    write_tensors(path, {name: np.ascontiguousarray(t) for name, t in tensors.items()}, said)


def read_weights(path: Path) -> tuple[Actor, dict[str, Any]]:
    """The actor in a file, and what the file says about it.

    Raises PluginError where the file is missing, cut short, foreign, or not of one piece.
    """
    file = read_tensors(path)
    if file.metadata.get("format") != FORMAT:
        raise PluginError(
            f"{path}: must be weights written by `benchnav train` (format {FORMAT!r})."
            f" Got the format {file.metadata.get('format')!r} instead."
        )
    about = json.loads(file.metadata["about"]) | {"sha256": file.sha256}
    name = about.get("encoder")
    if name not in ENCODERS:
        raise PluginError(f"{path}: made for the encoder {name!r}, which does not exist.")
    actor = _fitting(path, file.tensors, encoder(name).size, name)
    return actor, about


def _fitting(path: Path, tensors: Mapping[str, Float32Array], size: int, name: str) -> Actor:
    try:
        actor = Actor(tensors)
    except KeyError as error:
        raise PluginError(f"{path}: the tensor {error} must be there. It is not.") from None
    width = size
    for k, layer in enumerate(actor.lstm):
        hidden = len(layer.bias) // 4
        _demand(path, f"lstm{k}", layer.weight.shape, (width + hidden, 4 * hidden), name)
        width = hidden
    for what, dense in [*((f"dense{k}", d) for k, d in enumerate(actor.dense)),
                        ("output", actor.output)]:  # fmt: skip
        _demand(path, what, dense.weight.shape, (width, len(dense.bias)), name)
        width = len(dense.bias)
    _demand(path, "output", (width,), (2,), name)
    for key, tensor in tensors.items():
        if tensor.dtype != np.float32 or not np.isfinite(tensor).all():
            raise PluginError(f"{path}: {key} must be finite float32. Got {tensor.dtype} instead.")
    return actor


def _demand(path: Path, what: str, got: tuple[int, ...], want: tuple[int, ...], name: str) -> None:
    if tuple(got) != want:
        raise PluginError(
            f"{path}: {what} must have the shape {want} for the encoder {name!r}."
            f" Got {tuple(got)} instead."
        )
