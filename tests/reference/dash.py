"""The slow, obvious twin of `benchnav_baselines.learned.recurrent_ppo.dash`."""

import itertools
import math

import numpy as np
from benchnav_baselines.learned.recurrent_ppo import foresight as f

from .foresight import danger_held, places


def dash(seen, bodies, tolerance, b, a, hold):
    """The twist with which agent (b, a) is first at its goal, without a contact; None: none."""
    top, rate = bodies.max_speed[b, a], bodies.max_turn_rate[b, a]
    twists = itertools.product(
        np.linspace(0, top, f.SPEEDS),
        np.linspace(-rate, rate, f.TURNS),
        np.arange(f.HELD, hold + 1e-9, f.HELD),
    )
    dashes = [
        (arrival((v, w), seen, tolerance, b, a, held), v, w)
        for v, w, held in twists
        if danger_held((v, w), seen, bodies, tolerance, b, a, held) <= f.BACK
    ]
    time, v, w = min(dashes, key=lambda one: one[0], default=(math.inf, 0, 0))
    return None if time == math.inf else (v, w)


def arrival(twist, seen, tolerance, b, a, held):
    """The time [s] at which the agent is at its goal; inf: not before the horizon."""
    for k, spot in enumerate(places(twist, seen, b, a, held)):
        if math.dist(spot, seen.goal[b, a]) < tolerance[b, a]:
            return (k + 1) * f.TICK
    return math.inf
