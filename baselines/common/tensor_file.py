"""Read and write learned arrays as safetensors with JSON metadata, never as pickle."""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from safetensors.numpy import load, save

from benchnav.arrays import AnyArray
from benchnav.errors import PluginError
from benchnav.system.plain_file import read_file

MAX_BYTES = 1 << 30
_KEY = "about"


@dataclass(frozen=True, eq=False)
class TensorFile:
    """The content of a file."""

    tensors: Mapping[str, AnyArray]
    about: Mapping[str, Any]  # plain data
    sha256: str  # of its bytes


def write_tensors(path: Path, tensors: Mapping[str, AnyArray], about: Mapping[str, Any]) -> None:
    """Write atomically: a reader sees the old file or the new one.

    One key holds all of ``about``, because the library writes several keys in a varying order.
    """
    part = path.with_name(path.name + ".part")
    part.write_bytes(save(dict(tensors), {_KEY: json.dumps(about, sort_keys=True)}))
    part.replace(path)


def content_of(path: Path, limit: int) -> bytes:
    """Return the bytes of a file. Raises PluginError if it cannot be read or has over ``limit``."""
    try:
        data = read_file(path, limit)
    except OSError as error:
        raise PluginError(f"{path}: cannot be read: {error.strerror}.") from None
    if len(data) > limit:
        raise PluginError(f"{path}: must have at most {limit} bytes; it is larger.")
    return data


def read_tensors(path: Path) -> TensorFile:
    """Read a file. Raises PluginError if it is missing, truncated, or something else."""
    data = content_of(path, MAX_BYTES)
    try:
        tensors = load(data)
        header = json.loads(data[8 : 8 + int.from_bytes(data[:8], "little")])
        about = json.loads(header.get("__metadata__", {}).get(_KEY, "{}"))
    except Exception as error:
        raise PluginError(
            f"{path}: must be a complete safetensors file. It is truncated or something else:"
            f" {str(error)[:200]}."
        ) from None
    if not isinstance(about, dict):
        raise PluginError(
            f"{path}: must hold facts about its arrays. Got {str(about)[:80]} instead."
        )
    return TensorFile(tensors, about, hashlib.sha256(data).hexdigest())
