"""Slow twin of `benchnav.metrics.quantities.people`: the formulas, one pair and frame at a time."""

import math

import numpy as np

RATE, R_SOC, L_MIN, TAU_0 = 5.0, 0.8, 0.2, 3.0
PERSONAL, CLOSEST, SOONEST = 1.2, 0.26, 0.3


def velocity(place, there, f):
    """Central difference [m/s], one-sided at the ends of a track."""
    before = f - 1 if f > 0 and there[f - 1] else f
    after = f + 1 if f + 1 < len(place) and there[f + 1] else f
    if before == after:
        return np.zeros(2)
    return (place[after] - place[before]) * RATE / (after - before)


def time_to_collision(offset, motion, reach):
    """First t ≥ 0 with |offset + motion t| = reach, from the roots; 0 in a closing overlap."""
    if offset @ motion >= 0.0:
        return math.inf
    if offset @ offset <= reach * reach:
        return 0.0
    roots = np.roots([motion @ motion, 2.0 * offset @ motion, offset @ offset - reach * reach])
    return float(roots.real.min()) if np.isreal(roots).all() else math.inf


def numbers(agent, others, f):
    """(intrusion, avoidance, approach) of one (place, there, radius, preferred) in frame f."""
    place, there, radius, preferred = agent
    found = [0.0, 0.0, 0.0]
    own = velocity(place, there, f)
    for where, present, size in others:
        if not (there[f] and present[f]):
            continue
        offset = place[f] - where[f]
        apart = math.hypot(*offset)
        if apart <= 3.0 * R_SOC:
            found[0] += ((R_SOC - L_MIN) / (max(apart, CLOSEST) - L_MIN)) ** 2
        motion = own - velocity(where, present, f)
        time = time_to_collision(offset, motion, radius + size)
        found[1] = max(found[1], TAU_0 / max(time, SOONEST))
        if apart - radius - size < PERSONAL:
            towards = -(own @ offset) / apart / preferred
            found[2] = max(found[2], min(max(towards, 0.0), 1.0))
    return found
