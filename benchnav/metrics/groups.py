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
from benchnav.metrics.quantities.numpy_sum import numpy_sum

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
    return _over_teams(episode, members, spreads)


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
    return _over_teams(episode, members, orders)


@metric(title="Connected parts of a team", unit="", better=None, low=1.0, scope="group")
def splits(episode: Episode, members: BoolArray) -> float:
    """Number of connected parts of the team; centres within three diameters are connected."""
    return _over_teams(episode, members, part_counts)


Instants = Callable[[FloatArray, FloatArray, BoolArray, FloatArray], FloatArray]


def _over_teams(episode: Episode, members: BoolArray, value: Instants) -> float:
    """Return the mean over teams and time of ``value(place, step, active, radius)``."""
    means = []
    for team in analyse(episode).teams_together(members):
        values = value(*team)
        means.append(values[~np.isnan(values)])
    defined = [float(mean.mean()) for mean in means if len(mean)]
    return float(np.mean(defined)) if defined else math.nan


@kernel
def spreads(
    place: FloatArray, step: FloatArray, active: BoolArray, radius: FloatArray
) -> FloatArray:
    """Return the spread (N,) of places (n, N, 2), over the active members (n, N)."""
    n, instants = active.shape
    spread, distance, radii = np.empty(instants), np.empty(n), np.empty(n)
    for k in range(instants):
        count = 0
        for a in range(n):
            count += active[a, k]
        x, y = 0.0, 0.0
        for a in range(n):
            share = active[a, k] / count
            x, y = x + place[a, k, 0] * share, y + place[a, k, 1] * share
        for a in range(n):
            share = active[a, k] / count
            distance[a] = math.hypot(place[a, k, 0] - x, place[a, k, 1] - y) * share
            radii[a] = radius[a] * share
        packed = math.sqrt(count * math.sqrt(12.0) / math.pi)
        mean_distance, mean_radius = _sum(distance, instants), _sum(radii, instants)
        spread[k] = mean_distance / (2.0 / 3.0 * mean_radius * packed)
    return spread


@kernel
def _sum(values: FloatArray, columns: int) -> float:
    """Return the sum of one of several columns in numpy's order: row by row, except of one."""
    if columns == 1:
        return numpy_sum(values)
    total = 0.0
    for value in values:
        total += value
    return total


@kernel
def orders(
    place: FloatArray, step: FloatArray, active: BoolArray, radius: FloatArray
) -> FloatArray:
    """Return the Vicsek order (N,); NaN if no agent moves."""
    n, instants = active.shape
    order = np.empty(instants)
    for k in range(instants):
        x, y, count = 0.0, 0.0, 0
        for a in range(n):
            length = math.hypot(step[a, k, 0], step[a, k, 1])
            moves = active[a, k] and length > STILL
            scale = 1.0 / length if moves else 0.0
            x, y = x + scale * step[a, k, 0], y + scale * step[a, k, 1]
            count += moves
        order[k] = math.hypot(x, y) / count if count > 0 else math.nan
    return order


@kernel
def part_counts(
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
