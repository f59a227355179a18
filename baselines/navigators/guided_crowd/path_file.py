"""Guiding paths in a JSON file, to view, reuse or draw them.

{"format": "benchnav guiding paths", "version": 1, "paths": [
  {"points": [[x, y], …], "duration": s, "turning": rad, "radius": m,
   "rehearsals": n, "succeeded": n}, …]}
"""

import hashlib
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from benchnav.config.model_errors import first_problem
from benchnav.errors import InputError
from benchnav.system.plain_file import read_file

from .guiding_path import GuidingPath, arc_length, distinct

MAX_BYTES = 256 << 20
Number = Annotated[float, Field(allow_inf_nan=False)]


class _Path(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=False)

    points: list[tuple[Number, Number]] = Field(min_length=2, max_length=100_000)
    duration: Number = Field(0.0, ge=0)
    turning: Number = Field(0.0, ge=0)
    radius: Number = Field(0.0, ge=0)
    rehearsals: int = Field(0, ge=0)
    succeeded: int = Field(0, ge=0)


class _File(BaseModel):
    model_config = ConfigDict(extra="forbid")

    format: Literal["benchnav guiding paths"]
    version: Literal[1]
    paths: list[_Path] = Field(min_length=1, max_length=10_000)


def write_paths(file: Path | str, paths: Sequence[GuidingPath]) -> None:
    """Write guiding paths to ``file``; reading them gives the same numbers to the last bit."""
    lines = [
        json.dumps(
            {
                "points": path.points.tolist(), "duration": path.duration,
                "turning": path.turning, "radius": path.radius,
                "rehearsals": path.rehearsals, "succeeded": path.succeeded,
            },
            allow_nan=False,
        )
        for path in paths
    ]  # fmt: skip
    head = '{"format": "benchnav guiding paths", "version": 1, "paths": [\n'
    Path(file).write_text(head + ",\n".join(lines) + "\n]}\n", encoding="utf-8")


def read_paths(file: Path | str) -> tuple[GuidingPath, ...]:
    """Return the guiding paths in ``file``.

    Raises InputError if it cannot be read or has other content.
    """
    rule = f"{file} must be a file of guiding paths, as write_paths writes it."
    try:
        raw = read_file(Path(file), MAX_BYTES)
        if len(raw) > MAX_BYTES:
            raise InputError(f"{rule} It has more than {MAX_BYTES} bytes.")
        content = _File.model_validate_json(raw)
    except OSError as error:
        raise InputError(f"{rule} It cannot be read: {error.strerror}.") from error
    except ValidationError as error:
        problem = first_problem(error)
        raise InputError(f"{rule} {problem.key or 'It'} {problem.requirement}.") from None
    return tuple(_path(k, path, rule) for k, path in enumerate(content.paths))


def _path(k: int, content: _Path, rule: str) -> GuidingPath:
    points = distinct(np.array(content.points))
    if len(points) < 2 or not arc_length(points)[-1] > 0.0:
        raise InputError(f"{rule} paths.{k}.points: must have different points.")
    return GuidingPath(
        points,
        content.duration,
        content.turning,
        content.radius,
        content.rehearsals,
        content.succeeded,
    )


def fingerprint_of(file: Path | str) -> str:
    """Return the sha256 of the file."""
    return hashlib.sha256(read_file(Path(file), MAX_BYTES)).hexdigest()
