"""Following: the distance of followers from their leader's way, and the time to catch up.

Both are measured at 2 Hz until the follower's attempt ends, and are NaN for leaders.
A leader and its followers belong to one team. The guiding path is the way that a leader of
the team takes in the episode: a path from a rehearsal is an input of the navigator, and not
a result of the episode. The share of followers that arrive without a collision is `success`
in the rows of the followers.
"""

import math
from collections.abc import Iterator

import numpy as np

from benchnav.arena.agents import Role
from benchnav.arrays import BoolArray, FloatArray, IntArray
from benchnav.episode.episode import Episode
from benchnav.kernels import kernel
from benchnav.metrics.groups import label_parts
from benchnav.metrics.metric import metric
from benchnav.metrics.quantities.density import FRAME_RATE
from benchnav.metrics.quantities.episode_analysis import Analysis, analyse


@metric(
    title="Mean lateral distance of a follower from its leader's way",
    unit="m",
    better=None,
    low=0.0,
)
def path_keeping(episode: Episode) -> FloatArray:
    """(A,) [m] mean lateral distance of a follower from the way of its leader.

    The lateral distance is the distance to the nearest point of the leader's trajectory, from
    its start to its end. Instants at which an end is the nearest point do not count, because
    the follower is then before or past the path, and not beside it. With several leaders, the
    nearest way counts. NaN without a leader that moves by at least its radius, and for a
    follower that is never beside the path.
    """
    found = analyse(episode)
    kept = np.full(len(found.arrival), math.nan)
    if not _has_followers(found):
        return kept
    place, _, active = found.group_motion
    for followers, leaders in _teams(found):
        ways = [a for a in leaders if found.trajectories.moved[a]]
        if ways:
            points = [_way(found, a) for a in ways]
            first = np.cumsum([0, *(len(p) for p in points)])
            path = np.ascontiguousarray(np.vstack(points))
            kept[followers] = mean_lateral(place[followers], active[followers], path, first)
    return kept


@metric(
    title="Mean time from falling behind the group until back with it",
    unit="s",
    better=None,
    low=0.0,
)
def catch_up_time(episode: Episode) -> FloatArray:
    """(A,) [s] mean duration of the periods in which a follower is behind its group.

    A follower is behind while it is not connected, over centres within three diameters (as
    in `splits`), to the largest part of its team's followers, and its straight distance to its
    goal is larger than the mean of that part. If several parts are the largest, all of them
    count as the largest part. A period that lasts until the follower's attempt ends counts with
    its length until then. NaN for followers that are never behind.
    """
    found = analyse(episode)
    agents, times = found.world.agents, np.full(len(found.arrival), math.nan)
    if not _has_followers(found):
        return times
    place, _, active = found.group_motion
    for followers, _ in _teams(found):
        if len(followers) > 1:
            away = place[followers] - agents.goal[followers, None]
            left = np.hypot(away[..., 0], away[..., 1])
            lost = behind(place[followers], left, active[followers], agents.radius[followers])
            times[followers] = _mean_run(lost) / FRAME_RATE
    return times


def _has_followers(found: Analysis) -> bool:
    return bool((found.world.agents.role == int(Role.FOLLOWER)).any())


def _teams(found: Analysis) -> Iterator[tuple[IntArray, IntArray]]:
    """Yield followers and leaders (n,) of every team that has followers."""
    agents = found.world.agents
    for team in np.unique(agents.team):
        followers, leaders = (
            np.flatnonzero((agents.team == team) & (agents.role == int(role)))
            for role in (Role.FOLLOWER, Role.LEADER)
        )
        if len(followers):
            yield followers, leaders


def _way(found: Analysis, agent: int) -> FloatArray:
    """Return the path (P, 2) of an agent, without steps of length 0."""
    t = found.trajectories
    points = t.position[agent, : t.last[agent] + 1]
    step = np.diff(points, axis=0)
    moves = np.hypot(step[:, 0], step[:, 1]) > 0.0
    way: FloatArray = points[np.concatenate([[True], moves])]
    return way


def _mean_run(state: BoolArray) -> FloatArray:
    """Return the mean lengths (n,) of the runs of True in (n, N); NaN without a run."""
    begins = state & ~np.pad(state, ((0, 0), (1, 0)))[:, :-1]
    runs = begins.sum(axis=1)
    return np.where(runs > 0, state.sum(axis=1) / np.maximum(runs, 1), math.nan)


@kernel
def mean_lateral(
    place: FloatArray, active: BoolArray, path: FloatArray, first: IntArray
) -> FloatArray:
    """Return means (n,) over instants (n, N) of distances of places (n, N, 2) to the nearest path.

    Path w has the points ``path[first[w]:first[w + 1]]``; `path_keeping` defines the instants
    that count.
    """
    mean = np.full(len(place), math.nan)
    for a in range(len(place)):
        total, count = 0.0, 0
        for k in range(place.shape[1]):
            if active[a, k]:
                distance = _lateral(place[a, k, 0], place[a, k, 1], path, first)
                if distance >= 0.0:
                    total += distance
                    count += 1
        if count > 0:
            mean[a] = total / count
    return mean


@kernel
def _lateral(x: float, y: float, path: FloatArray, first: IntArray) -> float:
    """Return the distance to the nearest path; -1 if its nearest point is an end of it."""
    least, at_end = math.inf, True
    for w in range(len(first) - 1):
        for p in range(first[w], first[w + 1] - 1):
            ux, uy = path[p + 1, 0] - path[p, 0], path[p + 1, 1] - path[p, 1]
            share = ((x - path[p, 0]) * ux + (y - path[p, 1]) * uy) / (ux * ux + uy * uy)
            before, past = share <= 0.0, share >= 1.0
            share = min(max(share, 0.0), 1.0)
            dx, dy = x - path[p, 0] - share * ux, y - path[p, 1] - share * uy
            away = dx * dx + dy * dy
            if away < least:
                least = away
                at_end = (before and p == first[w]) or (past and p == first[w + 1] - 2)
    return -1.0 if at_end else math.sqrt(least)


@kernel
def behind(place: FloatArray, left: FloatArray, active: BoolArray, radius: FloatArray) -> BoolArray:
    """Return the mask (n, N) of members behind their group, from distances ``left`` (n, N) [m]."""
    lost = np.zeros(active.shape, np.bool_)
    n = len(active)
    label, stack = np.empty(n, np.int64), np.empty(n, np.int64)
    for k in range(active.shape[1]):
        parts = label_parts(place[:, k], active[:, k], radius, label, stack)
        if parts < 2:
            continue
        size = np.zeros(parts, np.int64)
        for a in range(n):
            if active[a, k]:
                size[label[a]] += 1
        largest = size.max()
        total, count = 0.0, 0
        for a in range(n):
            if active[a, k] and size[label[a]] == largest:
                total += left[a, k]
                count += 1
        for a in range(n):
            apart = active[a, k] and size[label[a]] < largest
            lost[a, k] = apart and left[a, k] > total / count
    return lost
