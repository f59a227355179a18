"""Worlds with noisy senses for tests."""

from dataclasses import fields

import numpy as np

from benchnav.sensors.noise.noisy_senses import NoisySenses
from benchnav.world.simulation import Simulation

NEEDS = frozenset({"rays", "neighbours", "edges"})


def keys_of(count, first=0):
    """(count, 2) keys, of the worlds ``first`` to ``first + count - 1``."""
    return np.array([[1000 + first + b, 77] for b in range(count)], np.uint64)


def noisy(worlds, noise, keys=None, chosen=None):
    """A simulation of the worlds, and noisy senses of the agents ``chosen``: all."""
    simulation = Simulation(worlds)
    if chosen is None:
        chosen = np.tile(np.arange(simulation.A), (simulation.B, 1))
        chosen[~simulation.present] = -1
    senses = NoisySenses(simulation, chosen, noise)
    senses.begin(np.arange(simulation.B), keys_of(simulation.B) if keys is None else keys)
    return simulation, senses


def active(simulation, senses):
    return (senses._chosen >= 0) & (simulation.status == 0)


def state_of(simulation, senses):
    """Estimates (position, heading, velocity) of all agents."""
    state = simulation.position.copy(), simulation.heading.copy(), simulation.velocity.copy()
    senses.localise(*state)
    return state


def arrays_of(readings):
    """The arrays of rays, neighbours and edges."""
    return {
        f"{type(part).__name__}.{f.name}": getattr(part, f.name)
        for part in readings
        if part is not None
        for f in fields(part)
    }


def assert_same(left, right, b=slice(None), c=slice(None)):
    """The worlds b of ``left`` and c of ``right`` have equal bits."""
    left, right = arrays_of(left), arrays_of(right)
    assert left.keys() == right.keys()
    for name, value in left.items():
        both = (value, right[name])
        x, y = both if name == "Rays.angle" else (value[b], right[name][c])
        assert x.tobytes() == y.tobytes(), name
