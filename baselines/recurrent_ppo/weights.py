"""Weights on disk: safetensors with what is needed to use and to judge them; no pickle."""

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from benchnav.envs.encoders.catalogue import ENCODERS, encoder
from benchnav.errors import MissingExtraError, PluginError

from .actor import Actor, Float32Array

FORMAT = "benchnav-actor-1"


def write_weights(path: Path, tensors: Mapping[str, Float32Array], about: dict[str, Any]) -> None:
    """Atomically. ``about`` holds plain data and must name the encoder."""
    save = _safetensors().save
    said = {"format": FORMAT, "about": json.dumps(about, sort_keys=True)}
    data = save({name: np.ascontiguousarray(t) for name, t in tensors.items()}, said)
    part = path.with_name(path.name + ".part")
    part.write_bytes(data)
    part.replace(path)


def read_weights(path: Path) -> tuple[Actor, dict[str, Any]]:
    """The actor in a file, and what the file says about it.

    Raises PluginError where the file is missing, cut short, foreign, or not of one piece.
    """
    tensors, metadata, data = _read(path)
    if metadata.get("format") != FORMAT:
        raise PluginError(
            f"{path}: must be weights written by `benchnav train` (format {FORMAT!r})."
            f" Got the format {metadata.get('format')!r} instead."
        )
    about = json.loads(metadata["about"]) | {"sha256": hashlib.sha256(data).hexdigest()}
    name = about.get("encoder")
    if name not in ENCODERS:
        raise PluginError(f"{path}: made for the encoder {name!r}, which does not exist.")
    actor = _fitting(path, tensors, encoder(name).size, name)
    return actor, about


def _fitting(path: Path, tensors: dict[str, Float32Array], size: int, name: str) -> Actor:
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


def _read(path: Path) -> tuple[dict[str, Float32Array], dict[str, str], bytes]:
    library = _safetensors()
    try:
        data = path.read_bytes()
        tensors = library.load(data)
        header = int.from_bytes(data[:8], "little")
        metadata = json.loads(data[8 : 8 + header]).get("__metadata__", {})
    except OSError as error:
        raise PluginError(f"{path}: cannot be read: {error.strerror}.") from None
    except Exception as error:
        raise PluginError(
            f"{path}: must be a whole safetensors file. It is cut short or something else:"
            f" {str(error)[:200]}."
        ) from None
    return tensors, metadata, data


def _safetensors() -> Any:
    try:
        import safetensors.numpy
    except ImportError:
        raise MissingExtraError("A learned navigator", "learn") from None
    return safetensors.numpy
