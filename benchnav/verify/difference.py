"""The first difference of two values: types, shapes and every bit of every float."""

from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np

from benchnav.arrays import AnyArray
from benchnav.text.visible import shortened

_BITS = {8: np.uint64, 4: np.uint32, 2: np.uint16, 1: np.uint8}


def first_difference(stored: Any, right: Any, name: str = "") -> str:
    """Return ``"agents.start[3, 0] is 1.5, not 1.25"``; ``""`` if the values are equal."""
    if isinstance(stored, np.ndarray) and isinstance(right, np.ndarray):
        return _of_arrays(stored, right, name)
    if is_dataclass(stored) and type(stored) is type(right):
        dot = f"{name}." if name else ""
        pairs = [(f.name, getattr(stored, f.name), getattr(right, f.name)) for f in fields(stored)]
        return next(filter(None, (first_difference(a, b, dot + key) for key, a, b in pairs)), "")
    if isinstance(stored, tuple) and isinstance(right, tuple):
        if len(stored) != len(right):
            return f"{name} has {len(stored)} items, not {len(right)}"
        items = enumerate(zip(stored, right, strict=True))
        return next(
            filter(None, (first_difference(a, b, f"{name}[{i}]") for i, (a, b) in items)), ""
        )
    if isinstance(stored, float) and isinstance(right, float):
        same = np.float64(stored).tobytes() == np.float64(right).tobytes()
    else:
        same = stored == right and isinstance(stored, bool) == isinstance(right, bool)
    return "" if same else f"{name} is {_shown(stored)}, not {_shown(right)}"


def _of_arrays(stored: AnyArray, right: AnyArray, name: str) -> str:
    if stored.dtype != right.dtype:
        return f"{name} is of {stored.dtype}, not {right.dtype}"
    if stored.shape != right.shape:
        return f"{name} has shape {stored.shape}, not {right.shape}"
    bits = _BITS[stored.dtype.itemsize]
    differs = np.ascontiguousarray(stored).view(bits) != np.ascontiguousarray(right).view(bits)
    if not differs.any():
        return ""
    at = tuple(int(k) for k in np.argwhere(differs)[0])
    count = int(differs.sum())
    more = f", and {count - 1} more" if count > 1 else ""
    index = f"[{', '.join(map(str, at))}]" if at else ""
    return f"{name}{index} is {_shown(stored[at])}, not {_shown(right[at])}{more}"


def _shown(value: Any) -> str:
    return shortened(repr(value.item() if isinstance(value, np.generic) else value), 80)
