"""Congestion: the density of the crowd, and its effect on motion.

Density, congestion level and velocity fluctuation describe every agent in the
measurement area, background agents included; flow and jam are those of the members.
Metrics that need a measurement area are NaN if the world defines none.
"""

import math

import numpy as np

from benchnav.arrays import BoolArray, Extent, FloatArray
from benchnav.episode.episode import Episode
from benchnav.kernels import kernel
from benchnav.metrics.metric import metric
from benchnav.metrics.quantities.density import frame_times
from benchnav.metrics.quantities.episode_analysis import Analysis, analyse
from benchnav.metrics.quantities.numpy_sum import numpy_sum
from benchnav.metrics.quantities.trajectory import positions_at, present_at

SLOW = 0.2  # of the preferred speed
CELL = 0.5  # [m] of the velocity field of the congestion level
WINDOW = 10.0  # [s] over which that field is averaged
_STEFFEN = "Steffen & Seyfried 2010, as PedPy computes it"


@metric(
    title="Share of time slow beside another agent and not at the goal",
    unit="",
    better=None,
    low=0.0,
    high=1.0,
)
def jam(episode: Episode) -> FloatArray:
    """(A,) share of the attempt in which an agent is jammed.

    An agent is jammed while it is slower than 0.2 × its preferred speed, is not at its goal, and
    the centre of another agent is within two of its diameters.

    NaN for an agent whose attempt ended at its start.
    """
    found, slow = analyse(episode), SLOW * episode.world.agents.preferred_speed
    t, share = found.trajectories, np.empty(len(slow))
    write_jam(t.speed, t.duration, t.total_duration, found.encounters.near, slow, share)
    return share


@kernel
def write_jam(
    speed: FloatArray, duration: FloatArray, total: FloatArray, near: BoolArray,
    slow: FloatArray, share: FloatArray,
) -> None:  # fmt: skip
    """Write the shares (A,) of time of `jam`, for agents slower than ``slow`` (A,) [m/s]."""
    jammed = np.empty(duration.shape[1])
    for a in range(len(duration)):
        for k in range(duration.shape[1]):
            jammed[k] = duration[a, k] if speed[a, k] < slow[a] and near[a, k] else 0.0
        share[a] = numpy_sum(jammed) / total[a] if total[a] > 0.0 else math.nan


@metric(
    title="Mean Voronoi density in the measurement area",
    unit="1/m²",
    better=None,
    low=0.0,
    reference=_STEFFEN,
    scope="group",
)
def density_mean(episode: Episode, members: BoolArray) -> float:
    """[1/m²] mean over time, at 1 Hz, of the Voronoi density.

    Cells are cut at a distance of 0.8 m from their agent, so they are smaller than about 2 m².
    """
    density = analyse(episode).density
    return float(density.mean()) if len(density) else math.nan


@metric(
    title="Greatest Voronoi density in the measurement area",
    unit="1/m²",
    better=None,
    low=0.0,
    reference=_STEFFEN,
    scope="group",
)
def density_peak(episode: Episode, members: BoolArray) -> float:
    """[1/m²] greatest Voronoi density, at 1 Hz."""
    density = analyse(episode).density
    return float(density.max()) if len(density) else math.nan


@metric(
    title="Flow through the middle line of the measurement area",
    unit="1/s",
    better=None,
    low=0.0,
    scope="group",
)
def flow(episode: Episode, members: BoolArray) -> float:
    """[1/s] flow of members (A,) through the line that halves the measurement area.

    The line is perpendicular to the axis along which the agents' goals are farther from their
    starts. The flow of N agents is (N − 1) over the time between the first and the last
    crossing, with only the first crossing of each agent; NaN for fewer than two agents.
    """
    area = episode.world.measurement_area
    if area is None:
        return math.nan
    times = np.sort(first_crossings(analyse(episode), area)[members])
    times = times[np.isfinite(times)]
    if len(times) < 2 or times[-1] <= times[0]:
        return math.nan
    return float((len(times) - 1) / (times[-1] - times[0]))


def first_crossings(found: Analysis, area: Extent) -> FloatArray:
    """Return times (A,) [s] of the first crossing of the middle line of ``area``; inf if none."""
    agents, t = found.world.agents, found.trajectories
    x = int(np.argmax(np.abs(agents.goal - agents.start).sum(axis=0)))  # the main axis of motion
    y = 1 - x
    middle = 0.5 * (area[x] + area[x + 2])
    before, after = t.position[:, :-1, x] - middle, t.position[:, 1:, x] - middle
    crosses = ((before < 0.0) & (after >= 0.0)) | ((before >= 0.0) & (after < 0.0))
    share = before / np.where(crosses, before - after, 1.0)
    at = t.position[:, :-1, y] + share * np.diff(t.position[..., y], axis=1)
    crosses &= (area[y] <= at) & (at <= area[y + 2])
    times = np.arange(t.duration.shape[1]) * t.dt + share * t.duration
    first: FloatArray = np.where(crosses, times, math.inf).min(axis=1, initial=math.inf)
    return first


@metric(
    title="Deviation of velocities from their mean in the measurement area",
    unit="m/s",
    better=None,
    low=0.0,
    reference="Helbing, Johansson & Al-Abideen 2007, whose variance is its square",
    scope="group",
)
def velocity_fluctuation(episode: Episode, members: BoolArray) -> float:
    """[m/s] deviation from the mean velocity of the agents in the measurement area.

    Root mean square over these agents, mean over time; instants with fewer than two agents in
    the area do not count.
    """
    area = episode.world.measurement_area
    if area is None:
        return math.nan
    found = analyse(episode)
    _, inside, velocity = _in_area(found, area, frame_times(found.trajectories))
    count = inside.sum(axis=0)
    weight = (inside / np.maximum(count, 1))[..., None]
    mean = (velocity * weight).sum(axis=0)
    variance = ((velocity - mean) ** 2 * weight).sum(axis=(0, 2))
    return float(np.sqrt(variance[count > 1]).mean()) if (count > 1).any() else math.nan


@metric(
    title="Range of rotation of the velocity field over mean speed",
    unit="1/m",
    better=None,
    low=0.0,
    reference="Feliciani & Nishinari 2018",
    scope="group",
)
def congestion_level(episode: Episode, members: BoolArray) -> float:
    """[1/m] (greatest − smallest rotation of the velocity field) / mean speed, mean over time.

    The definition is that of Feliciani & Nishinari. This project chose to average the field over
    windows of 10 s in square cells of about 0.5 m, and to compute the rotation around the
    corners with four visited cells. Windows with fewer than two such corners do not count.
    """
    area = episode.world.measurement_area
    if area is None:
        return math.nan
    found = analyse(episode)
    times = frame_times(found.trajectories)
    place, inside, velocity = _in_area(found, area, times)
    levels = []
    for first in np.arange(0.0, times[-1] + 1e-9, WINDOW):
        now = inside & (times >= first) & (times < first + WINDOW)
        levels.append(_level(place[now], velocity[now], area))
    defined = [level for level in levels if level == level]
    return float(np.mean(defined)) if defined else math.nan


def _level(place: FloatArray, velocity: FloatArray, area: Extent) -> float:
    """Return the congestion level of one window, from places and velocities (N, 2)."""
    low, size = np.array(area[:2]), np.array([area[2] - area[0], area[3] - area[1]])
    cells = np.maximum(1, np.round(size / CELL)).astype(np.int64)
    index = np.clip(((place - low) / size * cells).astype(np.int64), 0, cells - 1)
    flat = index[:, 0] * cells[1] + index[:, 1]
    count = np.bincount(flat, minlength=int(cells.prod())).reshape(*cells)
    field = (
        np.stack(
            [np.bincount(flat, v, int(cells.prod())).reshape(*cells) for v in velocity.T], axis=-1
        )
        / np.where(count > 0, count, np.nan)[..., None]
    )
    dx, dy = size / cells
    vx, vy = field[..., 0], field[..., 1]
    across = 0.5 * (vy[1:, :-1] + vy[1:, 1:] - vy[:-1, :-1] - vy[:-1, 1:]) / dx
    along = 0.5 * (vx[:-1, 1:] + vx[1:, 1:] - vx[:-1, :-1] - vx[1:, :-1]) / dy
    rotation = across - along
    rotation = rotation[np.isfinite(rotation)]
    speed = float(np.hypot(*velocity.T).mean()) if len(velocity) else 0.0
    if len(rotation) < 2 or speed <= 0.0:
        return math.nan
    return float(rotation.max() - rotation.min()) / speed


def _in_area(
    found: Analysis, area: Extent, times: FloatArray
) -> tuple[FloatArray, BoolArray, FloatArray]:
    """Return places (A, N, 2), the mask of the area (A, N), and velocities (A, N, 2) at ``times``.

    The velocity is the mean over half a second around the instant.
    """
    t = found.trajectories
    place = positions_at(t, times)
    inside = present_at(t, times) & (times[None] < t.end[:, None])
    inside &= (place >= area[:2]).all(axis=2) & (place <= area[2:]).all(axis=2)
    end = t.duration.shape[1] * t.dt
    before, after = np.maximum(times - 0.25, 0.0), np.minimum(times + 0.25, end)
    span = np.maximum(after - before, 1e-9)[None, :, None]
    velocity: FloatArray = (positions_at(t, after) - positions_at(t, before)) / span
    return place, inside, velocity
