"""Arrays as short texts: differences in time, sorted by byte, deflated, in base64.

`replay.js` reads them back. The order of the steps matters for the size: differences of motion
are small, so after the zigzag code three of four bytes are nearly always 0.
"""

import base64
import math
import zlib
from typing import Any

import numpy as np

from benchnav.arrays import AnyArray

LIMIT = 2**30  # of an integer: differences of two must fit 32 bits


def packed(array: AnyArray, quantum: float = 1.0) -> dict[str, Any]:
    """Return the JSON form of an array whose first axis is time.

    Args:
        array: (T, …) finite numbers.
        quantum: values are rounded to multiples of it.

    Returns:
        the shape, the quantum, and the data, where time is the last axis.
    """
    whole = np.rint(np.asarray(array, np.float64) / quantum).clip(-LIMIT, LIMIT).astype(np.int64)
    series = np.moveaxis(whole, 0, -1)
    steps = np.diff(series, axis=-1, prepend=0)
    zigzag = ((steps << 1) ^ (steps >> 63)).astype("<u4")
    planes = np.ascontiguousarray(zigzag).view(np.uint8).reshape(-1, 4).T
    data = zlib.compress(np.ascontiguousarray(planes).tobytes(), 9)
    return {
        "shape": list(whole.shape), "quantum": quantum, "data": base64.b64encode(data).decode(),
    }  # fmt: skip


def unpacked(text: dict[str, Any]) -> AnyArray:
    """Return the array of `packed`, as the page reads it."""
    shape = text["shape"]
    series = (*shape[1:], shape[0])
    raw = np.frombuffer(zlib.decompress(base64.b64decode(text["data"])), np.uint8)
    zigzag = np.ascontiguousarray(raw.reshape(4, math.prod(shape)).T).view("<u4").astype(np.int64)
    steps = ((zigzag >> 1) ^ -(zigzag & 1)).reshape(series)
    values: AnyArray = np.moveaxis(steps.cumsum(axis=-1), -1, 0) * text["quantum"]
    return values
