"""Slow twin of `benchnav.metrics.quantities.encounters`: every pair, every step, nothing skipped.

Distances within a step are found by minimising over a fine grid of instants and then
by ternary search, which needs no formula for segments: the gap to a convex partner is
convex in time while everything moves straight.
"""

import math

import numpy as np


def _ternary(function, low, high):
    for _ in range(100):
        third = (high - low) / 3.0
        if function(low + third) < function(high - third):
            high -= third
        else:
            low += third
    return function(0.5 * (low + high))


def _to_segment(p, capsule):
    a, b = np.array(capsule[:2]), np.array(capsule[2:4])
    along = b - a
    length2 = along @ along
    t = 0.0 if length2 == 0.0 else min(1.0, max(0.0, (p - a) @ along / length2))
    return math.hypot(*(p - a - t * along))


def _first_touch(gap_at, horizon):
    """First t in [0, horizon] with gap ≤ 0, by the convexity of the gap; inf if there is none."""
    if gap_at(1e-6) >= gap_at(0.0) - 1e-15:
        return math.inf
    if gap_at(0.0) <= 0.0:
        return 0.0
    low, high = 0.0, horizon
    for _ in range(200):  # where the gap is least
        third = (high - low) / 3.0
        if gap_at(low + third) < gap_at(high - third):
            high -= third
        else:
            low += third
    least = 0.5 * (low + high)
    if gap_at(least) > 0.0:
        return math.inf
    low, high = 0.0, least
    for _ in range(100):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if gap_at(middle) <= 0.0 else (middle, high)
    return high


def things(a, position, velocity, duration, last, radius, dt, capsules, body, offset, jumps):
    """(clearance, time to collision) of agent ``a`` against solids and bodies."""
    clearance, ttc = math.inf, math.inf
    for capsule, m in zip(capsules, body, strict=True):
        for k in range(max(int(last[a]), 1)):
            moves = last[a] > 0
            at, drift = np.zeros(2), np.zeros(2)
            if m >= 0:
                at = offset[m, k + 1] if jumps[m] and moves else offset[m, k]
                if moves and not jumps[m]:
                    drift = (offset[m, k + 1] - offset[m, k]) / dt
            w = velocity[a, k] - drift if moves else -drift
            reach = radius[a] + capsule[4]

            def gap(t, p=position[a, k] - at, w=w, capsule=capsule, reach=reach):
                return _to_segment(p + w * t, capsule) - reach

            clearance = min(
                clearance, _ternary(gap, 0.0, duration[a, k] if moves else 0.0), gap(0.0)
            )
            if moves:
                ttc = min(ttc, max(0.0, _first_touch(gap, 10.0) - duration[a, k]))
    return clearance, ttc


def pair(i, j, position, velocity, duration, last, leaves, radius, dt):
    """(clearance, time to collision, gap per state, near per state) of i against j."""
    states = position.shape[1]
    clearance, ttc = math.inf, math.inf
    gaps, near = np.full(states, math.inf), np.zeros(states, bool)
    end = min(max(last[i], last[j]), leaves[i], leaves[j])
    for k in range(min(last[i], end) + 1):
        apart = math.hypot(*(position[j, k] - position[i, k]))
        gaps[k], near[k] = apart - radius[i] - radius[j], apart <= 4.0 * radius[i]
        if k == 0:
            clearance = gaps[0]
        if k >= min(last[i], end):
            break
        own = duration[i, k]
        # j moves until its own end, and if it vanishes there, is gone for the rest
        other = duration[j, k] if k < last[j] else own
        until = min(own, other) if leaves[j] == last[j] else own

        def gap(t, k=k, other=other):
            p = position[j, k] + velocity[j, k] * min(t, other) - position[i, k]
            return math.hypot(*(p - velocity[i, k] * t)) - radius[i] - radius[j]

        def course(t, k=k):
            p = position[j, k] - position[i, k] + (velocity[j, k] - velocity[i, k]) * t
            return math.hypot(*p) - radius[i] - radius[j]

        first = min(until, other)
        clearance = min(clearance, _ternary(gap, 0.0, first), _ternary(gap, first, until))
        ttc = min(ttc, max(0.0, _first_touch(course, 10.0) - min(own, other)))
    return clearance, ttc, gaps, near
