"""Smoothness of motion, for agents that arrive: a crash after one straight metre is not smooth.

Turning is computed from the path. Jerk and spectrum need velocity at one fixed rate,
low-passed (`lowpass`), because they diverge at steps of velocity. An agent has velocity 0
before its start, so its first step of velocity counts; motion after its arrival does not
count. All are NaN for an agent that has not moved by at least its radius.
"""

import math
from collections.abc import Callable

import numpy as np

from benchnav.arrays import FloatArray
from benchnav.episode.episode import Episode
from benchnav.kernels import kernel, kernel_without_allocation
from benchnav.metrics.metric import metric
from benchnav.metrics.quantities.episode_analysis import analyse
from benchnav.metrics.quantities.lowpass import CUTOFF, RATE
from benchnav.metrics.quantities.numpy_sum import numpy_sum

THRESHOLD = 0.05  # SPARC's amplitude threshold, relative to the peak of the spectrum
EVERY = 2  # use every second sample: 10 Hz are enough for the spectrum of speed
PADDING = 4  # SPARC's zero padding, in powers of two
STILL = 1e-6  # [m] a shorter segment has no direction


@metric(
    title="Change of direction per way travelled",
    unit="rad/m",
    better="lower",
    low=0.0,
    reference="mean absolute curvature; own definition of its sampling",
    conditional=True,
)
def turning(episode: Episode) -> FloatArray:
    """(A,) [rad/m] ∫|dθ| of the direction of motion over the way travelled.

    Standing and turning on the spot have no direction of motion: the angle between the
    directions before and after counts. Angles are at most π.
    """
    found = analyse(episode)
    t, defined = found.trajectories, found.arrived & found.trajectories.moved
    segment, total = np.diff(t.position, axis=1), np.empty(len(t))
    # numpy's arctangent, which on some machines differs from that of kernels in the last bit
    write_turns(segment, np.arctan2(segment[..., 1], segment[..., 0]), total)
    return np.where(defined, total / np.where(defined, t.length, 1.0), math.nan)


@kernel
def write_turns(segment: FloatArray, angle: FloatArray, total: FloatArray) -> None:
    """Write the sums (A,) [rad] of turns between segments (A, T, 2) with directions (A, T)."""
    steps = segment.shape[1]
    change = np.zeros(max(steps - 1, 0))
    for a in range(len(segment)):
        held, known = 0.0, False
        for k in range(steps):
            turn = 0.0
            if math.hypot(segment[a, k, 0], segment[a, k, 1]) > STILL:
                if known:
                    turn = abs((angle[a, k] - held + math.pi) % (2.0 * math.pi) - math.pi)
                held, known = angle[a, k], True
            elif known:
                turn = abs(math.pi % (2.0 * math.pi) - math.pi)
            if k > 0:
                change[k - 1] = turn
        total[a] = numpy_sum(change)


@metric(
    title="Smoothness by jerk: log dimensionless jerk",
    unit="",
    better="higher",
    reference="Hogan & Sternad 2009; Balasubramanian et al. 2012",
    conditional=True,
)
def log_dimensionless_jerk(episode: Episode) -> FloatArray:
    """(A,) −ln( D³ / v_peak² · ∫ |d²v/dt²|² dt ), D the time until arrival.

    A minimum-jerk movement has −ln 204.8 = −5.32: its squared jerk is 720 L²/D⁵ and its
    largest speed 15/8 · L/D (Hogan & Sternad 2009).
    """
    return _each(episode, _dimensionless_jerk)


@metric(
    title="Smoothness by spectrum: spectral arc length of speed",
    unit="",
    better="higher",
    high=0.0,
    reference="Balasubramanian et al. 2015",
    conditional=True,
)
def sparc(episode: Episode) -> FloatArray:
    """(A,) spectral arc length of the speed profile up to 1 Hz; negative, 0 is the smoothest.

    As published (padding 4, amplitude threshold 0.05), but with the filter's 1 Hz as the
    largest frequency instead of the 10 Hz of hand movements.
    """
    return _each(episode, _spectral_arc_length)


def dimensionless_jerk(velocity: FloatArray, duration: float, rate: float) -> float:
    """Return D³ / v_peak² · ∫ |d²v/dt²|² dt of ``velocity`` (N, 2) [m/s] at ``rate`` [Hz]."""
    squares, peak2 = squared_jerk(np.ascontiguousarray(velocity), rate)
    return squares / rate * duration**3 / peak2


@kernel
def squared_jerk(velocity: FloatArray, rate: float) -> tuple[float, float]:
    """Return the sum of squared jerks [m²/s⁶] and the largest squared speed [m²/s²]."""
    count, scale = max(len(velocity) - 2, 0), rate**2
    squares, peak2 = np.empty(2 * count), 0.0
    for k in range(len(velocity)):
        vx, vy = velocity[k, 0], velocity[k, 1]
        peak2 = max(peak2, vx * vx + vy * vy)
    for k in range(count):
        for axis in range(2):
            before = velocity[k + 1, axis] - velocity[k, axis]
            after = velocity[k + 2, axis] - velocity[k + 1, axis]
            jerk = (after - before) * scale
            squares[2 * k + axis] = jerk * jerk
    return numpy_sum(squares), peak2


def spectral_arc_length(speed: FloatArray, rate: float, top: float = CUTOFF) -> float:
    """Return SPARC of ``speed`` (N,) sampled at ``rate`` [Hz], for frequencies up to ``top`` [Hz].

    Balasubramanian et al. 2015: the length of the spectrum's curve in the band between the
    first and last frequency above the threshold, both axes scaled to 1.
    NaN if the threshold leaves no band.
    """
    size = 2 ** (math.ceil(math.log2(len(speed))) + PADDING)
    count = int(top / (rate / size)) + 1
    spectrum = np.abs(np.fft.rfft(speed, size))
    peak, low, high = find_band(spectrum, count)
    if high <= low:
        return math.nan
    return -curve_length(spectrum, peak, low, high, (1.0 / (high - low)) ** 2)


@kernel_without_allocation
def find_band(spectrum: FloatArray, count: int) -> tuple[float, int, int]:
    """Return the peak of a spectrum, and the ends of the band in its first ``count`` values.

    The ends are the first and the last value above the threshold; 0 and 0 if there is none.
    """
    peak, low, high = spectrum[0], -1, -1
    for k in range(len(spectrum)):
        peak = max(peak, spectrum[k])
    for k in range(min(count, len(spectrum))):
        if spectrum[k] / peak >= THRESHOLD:
            high = k
            if low < 0:
                low = k
    return peak, max(low, 0), max(high, 0)


@kernel
def curve_length(spectrum: FloatArray, peak: float, low: int, high: int, step2: float) -> float:
    """Return the length of the spectrum's curve from ``low`` to ``high``, relative to its peak.

    ``step2`` is the square of a step of frequency.
    """
    parts = np.empty(high - low)
    for k in range(low, high):
        rise = spectrum[k + 1] / peak - spectrum[k] / peak
        parts[k - low] = math.sqrt(step2 + rise * rise)
    return numpy_sum(parts)


def _dimensionless_jerk(velocity: FloatArray, duration: float) -> float:
    value = dimensionless_jerk(velocity, duration, RATE)
    return -math.log(value) if value > 0.0 else math.nan


def _spectral_arc_length(velocity: FloatArray, duration: float) -> float:
    speed = np.hypot(velocity[::EVERY, 0], velocity[::EVERY, 1])
    return spectral_arc_length(speed, RATE / EVERY)


def _each(episode: Episode, measure: Callable[[FloatArray, float], float]) -> FloatArray:
    """Return ``measure(velocity, duration)`` (A,); NaN for agents without defined smoothness."""
    found = analyse(episode)
    values = np.full(len(found.arrival), math.nan)
    for agent, velocity in found.smooth_velocities.items():
        t = found.trajectories
        values[agent] = measure(velocity, float(t.end[agent] - t.begin[agent]))
    return values
