"""Angles and rotations from correctly rounded operations only.

libm's sine differs between machines. These functions use +, -, ×, ÷ and floor in a fixed
order, so that a simulated state has equal bits everywhere. They differ from libm's values by at
most 5e-16 (sine, cosine) and 1e-15 (arctangent).
"""

import math

import numpy as np

from benchnav.kernels import kernel_without_allocation

TWO_PI = 2.0 * math.pi
_HALF_PI = 0.5 * math.pi
# pi/2 in three parts (Cody & Waite 1980): k times the first part is exact for small k
_HALF_PI_A = 1.5707963267341256
_HALF_PI_B = 6.077100506303966e-11
_HALF_PI_C = 2.0222662487959506e-21
_TAN_PI_8 = math.sqrt(2.0) - 1.0


@kernel_without_allocation
def wrap(angle: float) -> float:
    """Return the angle [rad] in [-pi, pi)."""
    turns: float = np.floor((angle + math.pi) / TWO_PI)  # math.floor makes an integer: no vectors
    return angle - TWO_PI * turns


@kernel_without_allocation
def cos_sin(angle: float) -> tuple[float, float]:
    """Return (cos, sin) of a moderate angle [rad], by Taylor series on [-pi/4, pi/4]."""
    k = math.floor(angle / _HALF_PI + 0.5)
    x = ((angle - k * _HALF_PI_A) - k * _HALF_PI_B) - k * _HALF_PI_C
    z = x * x
    s = -1.0 / 1307674368000.0
    s = s * z + 1.0 / 6227020800.0
    s = s * z - 1.0 / 39916800.0
    s = s * z + 1.0 / 362880.0
    s = s * z - 1.0 / 5040.0
    s = s * z + 1.0 / 120.0
    s = s * z - 1.0 / 6.0
    s = x + x * z * s
    c = 1.0 / 20922789888000.0
    c = c * z - 1.0 / 87178291200.0
    c = c * z + 1.0 / 479001600.0
    c = c * z - 1.0 / 3628800.0
    c = c * z + 1.0 / 40320.0
    c = c * z - 1.0 / 720.0
    c = c * z + 1.0 / 24.0
    c = 1.0 - 0.5 * z + z * z * c
    # selections instead of branches, which are mispredicted for random angles
    quadrant = int(k) % 4
    odd = quadrant % 2 == 1
    cosine, sine = (s if odd else c), (c if odd else s)
    cosine = -cosine if quadrant == 1 or quadrant == 2 else cosine
    return cosine, -sine if quadrant >= 2 else sine


@kernel_without_allocation
def angle_of(x: float, y: float) -> float:
    """Return the direction [rad] of the vector (x, y) in [-pi, pi]; 0 for the zero vector."""
    ax, ay = abs(x), abs(y)
    swapped = ay > ax
    large, small = (ay if swapped else ax), (ax if swapped else ay)
    t = small / large if large != 0.0 else 0.0
    beyond = t > _TAN_PI_8
    turned = (t - 1.0) / (t + 1.0)
    a = (0.25 * math.pi if beyond else 0.0) + _arctan_small(turned if beyond else t)
    a = _HALF_PI - a if swapped else a
    a = math.pi - a if x < 0.0 else a
    return -a if y < 0.0 else a


@kernel_without_allocation
def _arctan_small(t: float) -> float:
    """Return the arctangent for |t| ≤ tan(pi/8) by Taylor series, to a last term below 1e-17."""
    z = t * t
    s = -1.0 / 43.0
    s = s * z + 1.0 / 41.0
    s = s * z - 1.0 / 39.0
    s = s * z + 1.0 / 37.0
    s = s * z - 1.0 / 35.0
    s = s * z + 1.0 / 33.0
    s = s * z - 1.0 / 31.0
    s = s * z + 1.0 / 29.0
    s = s * z - 1.0 / 27.0
    s = s * z + 1.0 / 25.0
    s = s * z - 1.0 / 23.0
    s = s * z + 1.0 / 21.0
    s = s * z - 1.0 / 19.0
    s = s * z + 1.0 / 17.0
    s = s * z - 1.0 / 15.0
    s = s * z + 1.0 / 13.0
    s = s * z - 1.0 / 11.0
    s = s * z + 1.0 / 9.0
    s = s * z - 1.0 / 7.0
    s = s * z + 1.0 / 5.0
    s = s * z - 1.0 / 3.0
    s = s * z + 1.0 / 1.0
    return s * t


def rotated(points: np.ndarray, angle: float) -> np.ndarray:
    """Return points (…, 2) rotated counter-clockwise by ``angle`` [rad] about the origin."""
    c, s = cos_sin(angle)
    x, y = points[..., 0], points[..., 1]
    return np.stack([c * x - s * y, s * x + c * y], axis=-1)
