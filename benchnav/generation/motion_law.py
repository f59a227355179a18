"""Motion laws with drawn numbers, and the paths that they sweep."""

import math
from pathlib import Path

import numpy as np

from benchnav.arena.body import AWAY, Law, LawKind, absent
from benchnav.arrays import FloatArray
from benchnav.geometry.rotation import TWO_PI, cos_sin
from benchnav.scenario.files.track_file import read_tracks
from benchnav.scenario.law import BackAndForth, CircleLaw, RecordedTrack, WaypointLoop
from benchnav.scenario.sampling.sampler import sample

_SLACK = 1e-6  # [s]
_CHORDS = 32  # straight pieces that cover a circle


def draw_law(law: BackAndForth | WaypointLoop | CircleLaw, rng: np.random.Generator) -> Law:
    """Return a drawn law about the origin."""
    if isinstance(law, CircleLaw):
        radius = sample(law.radius, rng)
        rate = sample(law.speed, rng) / radius
        angle = TWO_PI * (sample(law.phase, rng) % 1.0)
        points = np.array([[0.0, 0.0], [radius, angle]])
        return Law(LawKind.CIRCLE, np.array([-rate if law.clockwise else rate]), points, True)
    if isinstance(law, BackAndForth):
        return _back_and_forth(law, rng)
    corners = np.array([*law.points, law.points[0]])
    legs = np.diff(corners, axis=0)
    taken = np.sqrt(np.sum(legs * legs, axis=1)) / sample(law.speed, rng)
    times = np.concatenate([[0.0], np.cumsum(taken)])
    phase = float(times[-1]) * (sample(law.phase, rng) % 1.0)
    return Law(LawKind.TRACK, times, corners, True, phase)


def _back_and_forth(law: BackAndForth, rng: np.random.Generator) -> Law:
    half = 0.5 * sample(law.length, rng)
    c, s = cos_sin(sample(law.direction, rng))
    x, y = half * c, half * s
    way = math.sqrt(2.0 * x * (2.0 * x) + 2.0 * y * (2.0 * y)) / sample(law.speed, rng)
    phase = (way + way) * (sample(law.phase, rng) % 1.0)
    corners = np.array([[-x, -y], [x, y], [-x, -y]])
    return Law(LawKind.TRACK, np.array([0.0, way, way + way]), corners, True, phase)


def recorded_laws(law: RecordedTrack, folder: Path) -> list[Law]:
    """Return one law per recorded track, in the arena's frame."""
    tracks = [np.array(law.points)] if law.points is not None else read_tracks(law, folder)
    laws = []
    for track in tracks:
        points = track[:, 1:] * law.scale + np.array(law.offset)
        present = law.presence == "recorded"
        laws.append(track_law(track[:, 0], points, present=present, periodic=law.repeat))
    return laws


def track_law(
    times: FloatArray,
    points: FloatArray,
    *,
    present: bool,
    periodic: bool = False,
    phase: float = 0.0,
) -> Law:
    """Return the law that follows a track: ``times`` (T,) [s] ≥ 0, ``points`` (T, 2) [m].

    If ``present``, the body is absent until `_SLACK` before its first time, and from `_SLACK` after
    its last: the rounding of a clock never decides whether it is there. The smallest difference of
    two numbers lies between being there and being away. Otherwise it rests.
    """
    first, last = float(times[0]), float(times[-1])
    if present:
        away, end = np.array([AWAY]), last + _SLACK
        times = np.append(times, [end, math.nextafter(end, math.inf)])
        points = np.vstack([points, points[-1:], away])
        if first > _SLACK:
            begin = first - _SLACK
            before = [0.0, math.nextafter(begin, 0.0), begin]
            times = np.concatenate([before, times])
            points = np.vstack([away, away, points[:1], points])
            return Law(LawKind.TRACK, times, points, periodic, phase)
    if first > 0.0:
        times, points = np.concatenate([[0.0], times]), np.vstack([points[:1], points])
    return Law(LawKind.TRACK, times, points, periodic, phase)


def moved_law(law: Law, place: FloatArray) -> Law:
    """Return the law about ``place`` (2,) [m]."""
    if law.kind == LawKind.CIRCLE:
        points = law.points + np.vstack([place, np.zeros(2)])
    else:
        points = law.points + place
    return Law(law.kind, law.times, points, law.periodic, law.phase)


def swept(law: Law, radius: float) -> FloatArray:
    """Return capsules (Q, 5) that cover the path of a disc of ``radius`` [m]."""
    if law.kind == LawKind.CIRCLE:
        center, (reach, _) = law.points
        step = TWO_PI / _CHORDS
        ways = np.array([cos_sin(k * step) for k in range(_CHORDS + 1)])
        corners = center + reach * ways
        radius += reach * (1.0 - cos_sin(0.5 * step)[0])
    else:
        corners = law.points[~absent(law.points)]
        corners = corners if len(corners) > 1 else np.repeat(corners, 2, axis=0)
        if len(corners) == 3 and (corners[0] == corners[2]).all():  # back and forth
            (x0, y0), (x1, y1), _ = corners.tolist()
            return np.array([[x0, y0, x1, y1, radius]])
    ends = np.hstack([corners[:-1], corners[1:]])
    return np.hstack([ends, np.full((len(ends), 1), radius)])


def place_at_start(law: Law) -> FloatArray:
    """Return the position (2,) [m] at t = 0."""
    if law.kind == LawKind.CIRCLE:
        center, (reach, angle) = law.points
        start: FloatArray = center + reach * np.array(cos_sin(float(angle)))
        return start
    t = law.phase
    k = int(np.searchsorted(law.times, t, side="right")) - 1
    if k >= len(law.times) - 1:
        last: FloatArray = law.points[-1]
        return last
    share = (t - law.times[k]) / (law.times[k + 1] - law.times[k])
    between: FloatArray = law.points[k] + share * (law.points[k + 1] - law.points[k])
    return between
