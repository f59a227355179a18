"""Smoothness of motion, for agents that arrive: a crash after one straight metre is not smooth.

Turning is computed from the path. Jerk and spectrum need velocity at one fixed rate,
low-passed (`lowpass`), because they diverge at steps of velocity. An agent has velocity 0
before its start, so its first step of velocity counts; motion after its arrival does not
count. All are NaN for an agent that has not moved by at least its radius.
"""

import math
from collections.abc import Callable

import numpy as np

from benchnav.arrays import BoolArray, FloatArray
from benchnav.episode.episode import Episode
from benchnav.metrics.metric import metric
from benchnav.metrics.quantities.episode_analysis import analyse
from benchnav.metrics.quantities.lowpass import CUTOFF, RATE

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
    t = analyse(episode).trajectories
    segment = np.diff(t.position, axis=1)
    has = np.hypot(segment[..., 0], segment[..., 1]) > STILL
    latest = np.maximum.accumulate(np.where(has, np.arange(has.shape[1]), -1), axis=1)
    angle = np.arctan2(segment[..., 1], segment[..., 0])
    held = np.take_along_axis(angle, np.maximum(latest, 0), axis=1)
    change = np.diff(held, axis=1)
    change = np.abs(np.remainder(change + math.pi, 2.0 * math.pi) - math.pi)
    total = np.where(latest[:, :-1] >= 0, change, 0.0).sum(axis=1)
    defined = _defined(episode)
    return np.where(defined, total / np.where(defined, t.length, 1.0), math.nan)


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
    jerk = np.diff(velocity, n=2, axis=0) * rate**2
    peak2 = float((velocity**2).sum(axis=1).max())
    return float((jerk**2).sum()) / rate * duration**3 / peak2


def spectral_arc_length(speed: FloatArray, rate: float, top: float = CUTOFF) -> float:
    """Return SPARC of ``speed`` (N,) sampled at ``rate`` [Hz], for frequencies up to ``top`` [Hz].

    Balasubramanian et al. 2015: the length of the spectrum's curve in the band between the
    first and last frequency above the threshold, both axes scaled to 1.
    NaN if the threshold leaves no band.
    """
    size = 2 ** (math.ceil(math.log2(len(speed))) + PADDING)
    count = int(top / (rate / size)) + 1
    spectrum = np.abs(np.fft.rfft(speed, size))
    spectrum = spectrum[:count] / spectrum.max()
    band = np.flatnonzero(spectrum >= THRESHOLD)
    spectrum = spectrum[band[0] : band[-1] + 1] if len(band) else spectrum[:0]
    if len(spectrum) < 2:
        return math.nan
    rise = np.diff(spectrum)
    return -float(np.sqrt((1.0 / len(rise)) ** 2 + rise**2).sum())


def _dimensionless_jerk(velocity: FloatArray, duration: float) -> float:
    value = dimensionless_jerk(velocity, duration, RATE)
    return -math.log(value) if value > 0.0 else math.nan


def _spectral_arc_length(velocity: FloatArray, duration: float) -> float:
    speed = np.hypot(velocity[::EVERY, 0], velocity[::EVERY, 1])
    return spectral_arc_length(speed, RATE / EVERY)


def _defined(episode: Episode) -> BoolArray:
    found = analyse(episode)
    return found.arrived & found.trajectories.moved


def _each(episode: Episode, measure: Callable[[FloatArray, float], float]) -> FloatArray:
    """Return ``measure(velocity, duration)`` (A,); NaN for agents without defined smoothness."""
    found = analyse(episode)
    values = np.full(len(found.arrival), math.nan)
    for agent in np.flatnonzero(_defined(episode)):
        velocity = found.smooth_velocity(int(agent))
        values[agent] = measure(velocity, float(found.trajectories.end[agent]))
    return values
