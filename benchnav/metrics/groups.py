"""Groups: how close the members of a team stay together.

A value is a mean over time, at 2 Hz, while at least two of the team's members are on
their way, and then over the teams with at least two members. NaN if no team has two.
"""

import math
from collections.abc import Callable

import numpy as np

from benchnav.arrays import BoolArray, FloatArray, IntArray
from benchnav.episode.episode import Episode
from benchnav.kernels import kernel
from benchnav.metrics.metric import metric
from benchnav.metrics.quantities.episode_analysis import analyse

LINK = 3.0  # [diameters] largest distance of centres that are connected
STILL = 1e-9  # [m] a shorter step has no direction


@metric(
    title="Spread of a team over that of its closest packing",
    unit="",
    better=None,
    low=0.0,
    scope="group",
)
def cohesion(episode: Episode, members: BoolArray) -> float:
    """Mean distance to the centroid over that of as many discs in a hexagonal packing.

    n such discs of radius r fill a disc of radius R with n·2√3·r² = π·R², in which the mean
    distance to the centre is ⅔·R = ⅔·r·√(n·√12/π).
    """
    return _over_teams(episode, members, _spread)


@metric(
    title="How far a team moves in one direction",
    unit="",
    better=None,
    low=0.0,
    high=1.0,
    reference="Vicsek et al. 1995",
    scope="group",
)
def polarisation(episode: Episode, members: BoolArray) -> float:
    """Length of the mean of the unit vectors of motion of moving agents (Vicsek order)."""
    return _over_teams(episode, members, _order)


@metric(title="Connected parts of a team", unit="", better=None, low=1.0, scope="group")
def splits(episode: Episode, members: BoolArray) -> float:
    """Number of connected parts of the team; centres within three diameters are connected."""
    return _over_teams(episode, members, _parts)


Instants = Callable[[FloatArray, FloatArray, BoolArray, FloatArray], FloatArray]


def _over_teams(episode: Episode, members: BoolArray, value: Instants) -> float:
    """Return the mean over teams and time of ``value(place, step, active, radius)``."""
    means = []
    for team in analyse(episode).teams_together(members):
        values = value(*team)
        means.append(values[~np.isnan(values)])
    defined = [float(mean.mean()) for mean in means if len(mean)]
    return float(np.mean(defined)) if defined else math.nan


def _spread(
    place: FloatArray, step: FloatArray, active: BoolArray, radius: FloatArray
) -> FloatArray:
    """Return the spread (N,) of places (n, N, 2), over the active members (n, N)."""
    share = active / active.sum(axis=0)
    away = place - (place * share[..., None]).sum(axis=0)
    distance = (np.hypot(away[..., 0], away[..., 1]) * share).sum(axis=0)
    mean_radius = (radius[:, None] * share).sum(axis=0)
    packed = np.sqrt(active.sum(axis=0) * math.sqrt(12.0) / math.pi)
    spread: FloatArray = distance / (2.0 / 3.0 * mean_radius * packed)
    return spread


def _order(
    place: FloatArray, step: FloatArray, active: BoolArray, radius: FloatArray
) -> FloatArray:
    """Return the Vicsek order (N,); NaN if no agent moves."""
    length = np.hypot(step[..., 0], step[..., 1])
    moving = active & (length > STILL)
    unit = np.where(moving, 1.0 / np.where(moving, length, 1.0), 0.0)[..., None] * step
    count = moving.sum(axis=0)
    order = np.hypot(*unit.sum(axis=0).T) / np.maximum(count, 1)
    return np.where(count > 0, order, math.nan)


@kernel
def _parts(
    place: FloatArray, step: FloatArray, active: BoolArray, radius: FloatArray
) -> FloatArray:
    """Return the number (N,) of connected parts of the active members."""
    n, instants = active.shape
    parts = np.zeros(instants)
    label, stack = np.empty(n, np.int64), np.empty(n, np.int64)
    for k in range(instants):
        parts[k] = label_parts(place[:, k], active[:, k], radius, label, stack)
    return parts


@kernel
def label_parts(
    place: FloatArray, active: BoolArray, radius: FloatArray, label: IntArray, stack: IntArray
) -> int:
    """Return the number of connected parts of active agents (n,); write parts to ``label`` (n,).

    Each part is filled from a seed, neighbour by neighbour. Inactive agents get label -1;
    ``stack`` (n,) is scratch.
    """
    parts = 0
    label[:] = -1
    for seed in range(len(active)):
        if not active[seed] or label[seed] >= 0:
            continue
        label[seed] = parts
        stack[0], top = seed, 1
        while top > 0:
            top -= 1
            i = stack[top]
            for j in range(len(active)):
                dx, dy = place[j, 0] - place[i, 0], place[j, 1] - place[i, 1]
                reach = LINK * (radius[i] + radius[j])
                if active[j] and label[j] < 0 and dx * dx + dy * dy <= reach * reach:
                    label[j] = parts
                    stack[top] = j
                    top += 1
        parts += 1
    return parts
