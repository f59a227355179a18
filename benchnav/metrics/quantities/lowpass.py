"""Velocity at one fixed rate, low-passed, as the input of derivatives and spectra.

Velocity is interpolated linearly between the middles of the segments, sampled at
20 Hz and smoothed by a Gaussian whose gain is 1/√2 at 1 Hz, below the step frequency
of walking, as is usual for pedestrian trajectories. The value then does not depend on the
decision step of the record, for steps up to 0.25 s.
"""

import itertools
import math

import numpy as np

from benchnav.arrays import FloatArray, IntArray
from benchnav.kernels import kernel
from benchnav.metrics.quantities.trajectory import Trajectories

RATE = 20.0  # [Hz] at which velocity is sampled
CUTOFF = 1.0  # [Hz] frequency at which the gain of the filter is 1/sqrt(2)
SIGMA = math.sqrt(math.log(2.0)) / (2.0 * math.pi * CUTOFF)  # [s] of the Gaussian
LEAD = 12  # samples before the start: 0.6 s, more than four sigma

_taps = np.exp(-0.5 * (np.arange(-LEAD, LEAD + 1) / (RATE * SIGMA)) ** 2)
TAPS = _taps / _taps.sum()


def smooth_velocities(trajectories: Trajectories, agents: IntArray) -> list[FloatArray]:
    """Return the velocity (N, 2) [m/s] of agents (n,) that moved, at RATE.

    It begins LEAD samples before the start of the agent, with velocity 0 until its start. After
    the end of its attempt, its last velocity is kept, so that only motion until then counts.
    """
    t = trajectories
    first = np.zeros(len(agents) + 1, np.int64)
    lasts = t.end[agents] - t.begin[agents]
    first[1:] = np.cumsum((lasts * RATE + 1e-9).astype(np.int64) + 1 + 3 * LEAD)
    samples = np.zeros((2, first[-1]))
    enters = np.zeros(len(t), np.int64) if t.enters is None else t.enters
    sample_velocities(t.velocity, t.duration, t.dt, enters, t.last, agents, first, samples)
    joined = np.convolve(samples.reshape(-1), TAPS, mode="valid")  # one call for all rows
    rows = len(joined) - first[-1]
    both = np.stack([joined[:rows], joined[first[-1] :]], axis=1)
    return [both[low : high - 2 * LEAD] for low, high in itertools.pairwise(first.tolist())]


@kernel
def sample_velocities(
    velocity: FloatArray, duration: FloatArray, dt: float, enters: IntArray, last: IntArray,
    agents: IntArray, first: IntArray, samples: FloatArray,
) -> None:  # fmt: skip
    """Write the velocities of agents (n,) before the filter to columns of ``samples`` (2, S).

    Those of agent n begin in column ``first[n]``, with zeros. Velocity is linear between the
    middles of the segments, as by `numpy.interp`.
    """
    middle = np.empty(duration.shape[1])
    for n in range(len(agents)):
        a, low, high = agents[n], first[n] + 2 * LEAD, first[n + 1]
        begin, count = enters[a], last[a]
        for k in range(begin, count):
            middle[k] = k * dt + 0.5 * duration[a, k]
        at = begin - 1  # the last middle that is not after the sample
        for m in range(low, high):
            time = (min(m, high - LEAD - 1) - low) / RATE + begin * dt
            while at + 1 < count and middle[at + 1] <= time:
                at += 1
            for axis in range(2):
                value = velocity[a, max(at, begin), axis]
                if begin <= at < count - 1 and middle[at] != time:
                    rise = velocity[a, at + 1, axis] - value
                    value = rise / (middle[at + 1] - middle[at]) * (time - middle[at]) + value
                samples[axis, m] = value
