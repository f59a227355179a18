"""Triangles of a mesh file, transformed to metres, z up, in the arena."""

import re
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any, Literal

import numpy as np

from benchnav.arrays import AnyArray, FloatArray, IntArray
from benchnav.errors import MeshError, MissingExtraError
from benchnav.geometry.rotation import rotated
from benchnav.system.plain_file import read_file

Up = Literal["x", "y", "z"]

FORMATS = (".dae", ".obj", ".off", ".ply", ".stl")
MAX_BYTES = 64 << 20
MAX_FACES = 1_000_000
_MERGE = 1e-6  # [m] closer vertices are merged

_UNIT = re.compile(rb"<unit\b[^>]*\bmeter\s*=\s*[\"']\s*([^\"']{1,40}?)\s*[\"']")
_UP = re.compile(rb"<up_axis>\s*([XYZ])_UP\s*</up_axis>")


def read_triangles(path: Path) -> tuple[FloatArray, IntArray, float, Up]:
    """Return vertices (V, 3) in the file's unit and axes, faces (F, 3), unit [m], up axis.

    Unit and up axis are read from a COLLADA file; they are 1 m and z for other formats.

    Raises:
        MeshError: not a mesh, or too large.
        MissingExtraError: trimesh is not installed.
    """
    raw = _bytes(path)
    vertices, faces = _load(path)
    if len(faces) == 0 or not np.isfinite(vertices).all():
        raise MeshError(f"{path}:1: the mesh must have triangles with finite corners; got none.")
    if len(faces) > MAX_FACES:
        raise MeshError(f"{path}:1: a mesh has at most {MAX_FACES} faces; got {len(faces)}.")
    return vertices, faces, *_declared(path, raw)


def place(
    vertices: FloatArray,
    unit: float,
    up: Up,
    scale: float | Sequence[float],
    yaw: float,
    at: Sequence[float],
) -> FloatArray:
    """Return vertices (V, 3) [m] in the arena: scaled along the file's axes, rotated, moved."""
    x, y, z = (vertices * np.broadcast_to(np.asarray(scale, np.float64), 3) * unit).T
    if up == "y":
        x, y, z = x, -z, y
    elif up == "x":
        x, y, z = -z, y, x
    plan = np.stack([x, y], axis=1)
    plan = rotated(plan, yaw) if yaw != 0.0 else plan
    offset = [*at, 0.0][:3]
    return np.column_stack([plan, z]) + np.asarray(offset, np.float64)


def merged(vertices: FloatArray, faces: IntArray) -> tuple[FloatArray, IntArray]:
    """Return the same triangles without duplicate vertices and degenerate faces."""
    _, first, index = np.unique(
        np.rint(vertices / _MERGE), axis=0, return_index=True, return_inverse=True
    )
    joined = index.reshape(-1)[faces]
    a, b, c = joined.T
    return vertices[first], joined[(a != b) & (b != c) & (c != a)]


def _bytes(path: Path) -> bytes:
    if path.suffix.lower() not in FORMATS:
        raise MeshError(
            f"{path}:1: a mesh file must end in one of {', '.join(FORMATS)}; got {path.suffix!r}."
        )
    try:
        raw = read_file(path, MAX_BYTES)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise MeshError(f"{path}:1: the mesh cannot be read: {reason}.") from None
    if len(raw) > MAX_BYTES:
        raise MeshError(f"{path}:1: a mesh file has at most {MAX_BYTES} bytes; it is larger.")
    if b"<!ENTITY" in raw:
        raise MeshError(f"{path}:1: a mesh file may not define XML entities.")
    return raw


def _load(path: Path) -> tuple[FloatArray, IntArray]:
    try:
        import trimesh
    except ImportError:
        raise MissingExtraError(f"the mesh {path}", "plan") from None
    if path.suffix.lower() == ".dae" and find_spec("collada") is None:
        raise MissingExtraError(f"the mesh {path}", "plan")
    try:
        scene: Any = trimesh.load_scene(str(path), process=False)
        mesh = scene.to_mesh()
        vertices: AnyArray = np.asarray(mesh.vertices, np.float64).reshape(-1, 3)
        faces: AnyArray = np.asarray(mesh.faces, np.int64).reshape(-1, 3)
    except Exception as error:  # every loader raises its own errors
        text = " ".join(str(error).split())[:120]
        raise MeshError(f"{path}:1: the file must be a mesh that trimesh reads: {text}.") from None
    return vertices, faces


def _declared(path: Path, raw: bytes) -> tuple[float, Up]:
    if path.suffix.lower() != ".dae":
        return 1.0, "z"
    up, unit = _UP.search(raw), _UNIT.search(raw)
    axis: Up = "y"  # COLLADA's default
    if up is not None:
        axis = "x" if up[1] == b"X" else "y" if up[1] == b"Y" else "z"
    try:
        metres = float(unit[1]) if unit is not None else 1.0
    except ValueError:
        metres = -1.0
    if not 0.0 < metres < float("inf"):
        line = raw.count(b"\n", 0, unit.start() if unit else 0) + 1
        raise MeshError(f"{path}:{line}: unit meter must be a number > 0.")
    return metres, axis
