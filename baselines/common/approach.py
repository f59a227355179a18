"""The velocity towards a point that does not pass it."""

import numpy as np

from benchnav.arrays import FloatArray


def approach(
    position: FloatArray, target: FloatArray, speed: FloatArray, dt: FloatArray
) -> FloatArray:
    """Return the velocity (…, 2) [m/s] from ``position`` (…, 2) towards ``target`` (…, 2) [m].

    Its length is ``speed`` (…) [m/s], or less if the target is less than one
    step ``dt`` (…) [s] away; zero at the target.
    """
    offset = target - position
    distance = np.sqrt(offset[..., 0] ** 2 + offset[..., 1] ** 2)
    length = np.minimum(speed, distance / np.where(dt > 0.0, dt, 1.0))
    scale = np.divide(length, distance, out=np.zeros_like(distance), where=distance > 0.0)
    velocity: FloatArray = offset * scale[..., None]
    return velocity
