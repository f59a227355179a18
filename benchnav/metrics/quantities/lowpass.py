"""Velocity at one fixed rate, low-passed, as the input of derivatives and spectra.

Velocity is interpolated linearly between the middles of the segments, sampled at
20 Hz and smoothed by a Gaussian whose gain is 1/√2 at 1 Hz, below the step frequency
of walking, as is usual for pedestrian trajectories. The value then does not depend on the
decision step of the record, for steps up to 0.25 s.
"""

import math

import numpy as np

from benchnav.arrays import FloatArray
from benchnav.metrics.quantities.trajectory import Trajectories

RATE = 20.0  # [Hz] at which velocity is sampled
CUTOFF = 1.0  # [Hz] frequency at which the gain of the filter is 1/sqrt(2)
SIGMA = math.sqrt(math.log(2.0)) / (2.0 * math.pi * CUTOFF)  # [s] of the Gaussian
LEAD = 12  # samples before the start: 0.6 s, more than four sigma

_taps = np.exp(-0.5 * (np.arange(-LEAD, LEAD + 1) / (RATE * SIGMA)) ** 2)
TAPS = _taps / _taps.sum()


def smooth_velocity(trajectories: Trajectories, agent: int) -> FloatArray:
    """Return the velocity (N, 2) [m/s] of one agent that moved, at RATE.

    It begins LEAD samples before the start of the agent, with velocity 0 until its start. After
    the end of its attempt, its last velocity is kept, so that only motion until then counts.
    """
    last, end = int(trajectories.last[agent]), float(trajectories.end[agent])
    middle = np.arange(last) * trajectories.dt + 0.5 * trajectories.duration[agent, :last]
    times = np.arange(int(end * RATE + 1e-9) + 1) / RATE
    samples = np.zeros((2, len(times) + 3 * LEAD))
    for axis in range(2):
        raw = np.interp(times, middle, trajectories.velocity[agent, :last, axis])
        samples[axis, 2 * LEAD : 2 * LEAD + len(times)] = raw
        samples[axis, 2 * LEAD + len(times) :] = raw[-1]
    return np.stack([np.convolve(axis, TAPS, mode="valid") for axis in samples], axis=1)
