"""Random numbers by a counter: a keyed hash of (decision, agent, channel, index).

The hash is Threefry-2x64 with 20 rounds (Salmon et al., Parallel Random Numbers: As Easy as 1, 2,
3, SC 2011), whose rounds are those of the cipher Threefish. A navigator that knows some of the
numbers can therefore not predict others.

Normal numbers are the inverse of the normal distribution (Wichura, Algorithm AS 241, Applied
Statistics 1988, PPND7, relative error below 1e-6) at one of 2³² midpoints. The largest is 6.34.
Only correctly rounded operations are used, so every machine draws equal bits.
"""

import math

import numpy as np

from benchnav.kernels import kernel_without_allocation

# channels of one agent at one decision; the index is a ray, a neighbour or an edge
RAY, NEIGHBOUR, MISSED_NEIGHBOUR, FALSE_ALARM, EDGE, ODOMETRY, CORRECTION = range(7)

_PARITY = np.uint64(0x1BD11BDAA9FC1A22)
_LOW, _32, _64 = np.uint64(0xFFFFFFFF), np.uint64(32), np.uint64(64)
_11, _INDEX_BITS = np.uint64(11), np.uint64(56)
_INDEX = np.uint64((1 << 56) - 1)
_SQRT_HALF, _LN_2 = math.sqrt(0.5), math.log(2.0)


@kernel_without_allocation
def draw(
    key_0: np.uint64, key_1: np.uint64, step: int, agent: int, channel: int, index: int
) -> tuple[np.uint64, np.uint64]:
    """Return two words of 64 random bits.

    Args:
        key_0: first half of the key of the world.
        key_1: second half of it.
        step: decisions done, below 2³².
        agent: index of the agent in its world, below 2³².
        channel: one of the channels above.
        index: of a ray, neighbour or edge; may be negative, above -2⁵⁵.
    """
    counter_0 = (np.uint64(step) << _32) | np.uint64(agent)
    counter_1 = (np.uint64(channel) << _INDEX_BITS) | (np.uint64(index) & _INDEX)
    return threefry(key_0, key_1, counter_0, counter_1)


@kernel_without_allocation
def threefry(
    key_0: np.uint64, key_1: np.uint64, counter_0: np.uint64, counter_1: np.uint64
) -> tuple[np.uint64, np.uint64]:
    """Return the counter, encrypted with the key by Threefry-2x64-20."""
    key_2 = key_0 ^ key_1 ^ _PARITY
    a, b = counter_0 + key_0, counter_1 + key_1
    for group in range(5):
        if group % 2 == 0:
            a, b = _mixed(a, b, np.uint64(16))
            a, b = _mixed(a, b, np.uint64(42))
            a, b = _mixed(a, b, np.uint64(12))
            a, b = _mixed(a, b, np.uint64(31))
        else:
            a, b = _mixed(a, b, np.uint64(16))
            a, b = _mixed(a, b, np.uint64(32))
            a, b = _mixed(a, b, np.uint64(24))
            a, b = _mixed(a, b, np.uint64(21))
        key_0, key_1, key_2 = key_1, key_2, key_0
        a, b = a + key_0, b + key_1 + np.uint64(group + 1)
    return a, b


@kernel_without_allocation
def _mixed(a: np.uint64, b: np.uint64, turn: np.uint64) -> tuple[np.uint64, np.uint64]:
    """Return one round: add, rotate, exclusive or."""
    a = a + b
    return a, ((b << turn) | (b >> (_64 - turn))) ^ a


@kernel_without_allocation
def uniform(word: np.uint64) -> float:
    """Return a number in [0, 1) from 53 bits of a word."""
    return float(word >> _11) * 2.0**-53


@kernel_without_allocation
def two_normals(word: np.uint64) -> tuple[float, float]:
    """Return two independent standard normal numbers from the halves of a word."""
    return normal(int(word >> _32)), normal(int(word & _LOW))


@kernel_without_allocation
def normal(k: int) -> float:
    """Return the standard normal number with the distribution function (k + 1/2) / 2³²."""
    q = (k - 2147483648 + 0.5) * 2.0**-32  # probability, minus 1/2
    if abs(q) <= 0.425:
        r = 0.180625 - q * q
        above = ((59.109374720 * r + 159.29113202) * r + 50.434271938) * r + 3.3871327179
        below = ((67.187563600 * r + 78.757757664) * r + 17.895169469) * r + 1.0
        return q * above / below
    r = math.sqrt(-_log(0.5 - abs(q)))
    if r <= 5.0:
        r -= 1.6
        above = ((0.17023821103 * r + 1.3067284816) * r + 2.7568153900) * r + 1.4234372777
        below = (0.12021132975 * r + 0.73700164250) * r + 1.0
    else:
        r -= 5.0
        above = ((0.017337203997 * r + 0.42868294337) * r + 3.0812263860) * r + 6.6579051150
        below = (0.012258202635 * r + 0.24197894225) * r + 1.0
    x = above / below
    return -x if q < 0.0 else x


@kernel_without_allocation
def _log(x: float) -> float:
    """Return the natural logarithm of x in (0, 1), by the series of the inverse hyperbolic tangent.

    The logarithm of libm differs between machines.
    """
    doublings = 0
    while x < _SQRT_HALF:
        x, doublings = 2.0 * x, doublings + 1
    t = (x - 1.0) / (x + 1.0)
    z = t * t
    s = 1.0 / 19.0
    s = s * z + 1.0 / 17.0
    s = s * z + 1.0 / 15.0
    s = s * z + 1.0 / 13.0
    s = s * z + 1.0 / 11.0
    s = s * z + 1.0 / 9.0
    s = s * z + 1.0 / 7.0
    s = s * z + 1.0 / 5.0
    s = s * z + 1.0 / 3.0
    return 2.0 * (t + t * z * s) - doublings * _LN_2
