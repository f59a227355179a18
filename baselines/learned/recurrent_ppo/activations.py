"""Exponential and hyperbolic tangent of float32 numbers, in code that compiles to vectors.

They compute what the GNU C library 2.36 computes, step by step, so that weights drive as they did
when it was called: `exp` as its expf (Szabolcs Nagy's, a table of 32 powers and a cubic polynomial
in float64), `tanh` as its tanhf and expm1f (Sun's fdlibm). The library's functions are chosen
by processor and version and cannot be called for several numbers at once; these use additions,
multiplications and divisions only, and have the same bits everywhere.
"""

# The constants and steps of `tanh` are those of fdlibm. Copyright (C) 1993 by Sun Microsystems,
# Inc. Developed at SunPro, a Sun Microsystems, Inc. business. Permission to use, copy, modify, and
# distribute this software is freely granted, provided that this notice is preserved.
# The constants of `exp` are those of Arm's optimized routines, Copyright (c) 2017-2018 Arm Limited,
# SPDX-License-Identifier: MIT.

import numpy as np

from benchnav.kernels import inlined

_POWERS = np.array([2.0 ** (k / 32) for k in range(32)]).view(np.int64)
_PER_POWER = 32.0 * float.fromhex("0x1.71547652b82fep+0")  # 32 / ln 2
_ROUND = float.fromhex("0x1.8p52")  # added to a number, leaves its nearest integer in the low bits
_CUBIC = float.fromhex("0x1.c6af84b912394p-5") / 32.0**3
_SQUARE = float.fromhex("0x1.ebfce50fac4f3p-3") / 32.0**2
_LINEAR = float.fromhex("0x1.62e42ff0c52d6p-1") / 32.0
_LIMIT = 100.0  # beyond it, float32 overflows, or the result is nothing beside 1

_ONE, _TWO, _THREE, _SIX, _HALF = (np.float32(x) for x in (1.0, 2.0, 3.0, 6.0, 0.5))
_LN2_HIGH, _LN2_LOW = np.float32(6.9313812256e-01), np.float32(9.0580006145e-06)
_PER_LN2 = np.float32(1.4426950216)
_Q1, _Q2, _Q3, _Q4, _Q5 = (
    np.float32(x)
    for x in (-3.3333335072e-02, 1.5873016091e-03, -7.9365076090e-05, 4.0082177293e-06,
              -2.0109921195e-07)
)  # fmt: skip
_SATURATED = np.float32(11.0)  # from 9.02 on the tangent is 1
_BIAS, _MANTISSA = np.int32(127), np.int32(23)
_SIGN = np.int32(-(2**31))
_NEAR, _FAR = np.int32(2), np.int32(22)


@inlined
def exp(x: np.float32) -> np.float32:
    """Return e to the power of ``x``; right beside 1 where it is smaller than 1e-37."""
    wide = float(x)
    wide = -_LIMIT if wide < -_LIMIT else wide
    wide = _LIMIT if wide > _LIMIT else wide
    z = _PER_POWER * wide
    rounded = z + _ROUND
    bits = np.float64(rounded).view(np.int64)
    r = z - (rounded - _ROUND)
    power = np.int64(_POWERS[bits & 31] + ((bits >> 5) << 52)).view(np.float64)
    return np.float32(((_CUBIC * r + _SQUARE) * (r * r) + (_LINEAR * r + 1.0)) * power)


@inlined
def tanh(x: np.float32) -> np.float32:
    """Return the hyperbolic tangent of ``x``."""
    size = abs(x)
    size = _SATURATED if size > _SATURATED else size
    small = size < _ONE
    double = size + size
    t = _expm1(-double if small else double)
    quotient = (-t if small else _TWO) / (t + _TWO)
    result = quotient if small else _ONE - quotient
    sign = np.float32(x).view(np.int32) & _SIGN
    return np.int32(np.float32(result).view(np.int32) | sign).view(np.float32)


@inlined
def _expm1(x: np.float32) -> np.float32:
    """Return e to the power of ``x``, minus 1, for -2 < x ≤ 0 and 2 ≤ x ≤ 22."""
    k = np.int32(_PER_LN2 * x + (_HALF if x > np.float32(0.0) else -_HALF))
    count = np.float32(k)
    high, low = x - count * _LN2_HIGH, count * _LN2_LOW
    r = high - low
    lost = (high - r) - low
    half = _HALF * r
    square = r * half
    series = _ONE + square * (_Q1 + square * (_Q2 + square * (_Q3 + square * (_Q4 + square * _Q5))))
    t = _THREE - series * half
    e = square * ((series - t) / (_SIX - r * t))
    e = r * (e - lost) - lost - square
    power = np.int32((_BIAS + k) << _MANTISSA).view(np.float32)
    inverse = np.int32((_BIAS - k) << _MANTISSA).view(np.float32)
    middle = ((_ONE - inverse) - (e - r)) * power
    large = ((r - (e + inverse)) + _ONE) * power
    negative = (_ONE - (e - r)) * power - _ONE
    result = middle if k <= _FAR else large
    result = negative if k <= -_NEAR else result
    result = _HALF * (r - e) - _HALF if k == np.int32(-1) else result
    return r - e if k == np.int32(0) else result
