"""Polygons around grown capsules: every side touches the capsule, so that nothing is cut."""

import math

import numpy as np

from benchnav.arrays import FloatArray


def capsule_polygons(capsules: FloatArray, inflation: float, segments: int) -> FloatArray:
    """Return corners (P, 4 segments, 2) [m] of polygons around grown capsules (P, 5).

    Every side touches the capsule: straight flanks keep their place, arcs are
    approximated from outside, by at most radius (1 / cos(π / (4 segments)) - 1). A polygon depends
    on its own capsule only, to the last bit.
    """
    ends = capsules[:, :4].reshape(-1, 2, 2)
    along = ends[:, 1] - ends[:, 0]
    length = np.sqrt(along[:, 0] * along[:, 0] + along[:, 1] * along[:, 1])[:, None]
    ahead = np.divide(along, length, out=np.tile([1.0, 0.0], (len(along), 1)), where=length > 0.0)
    step = 0.5 * math.pi / segments
    turn = (np.arange(4 * segments) + 0.5) * step - 0.5 * math.pi  # around the head, then the tail
    c, s = np.cos(turn), np.sin(turn)
    x, y = ahead[:, :1], ahead[:, 1:]
    reach = (capsules[:, 4:] + inflation) / math.cos(0.5 * step)
    centre = np.repeat(ends[:, ::-1], 2 * segments, axis=1)
    out = np.stack([c * x - s * y, s * x + c * y], axis=-1)
    return np.asarray(centre + reach[..., None] * out)
