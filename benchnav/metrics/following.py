"""Following: how followers keep to their leader's way, and what becomes of those who fall behind.

Both are of followers alone, NaN for leaders, and taken at 2 Hz until the follower's
attempt is over. Leader and followers are those of one team. The guiding path is the way
that a leader of the team takes in the episode itself: a path that was rehearsed before is
part of what the navigator was told, not of what happened. How many followers arrive
without a collision is `success` in the rows of the followers.
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
    """(A,) [m] mean distance of a follower from the way that its leader took.

    Lateral distance: that to the nearest point of the leader's trajectory, from its start
    to its end. Instants at which an end is the nearest point do not count, for the follower
    is then before the path or past it, and not beside it. Of several leaders the nearest
    way counts. NaN without a leader that moved by its own radius, and for a follower that
    was never beside its path.
    """
    found = analyse(episode)
    place, _, active = found.group_motion
    kept = np.full(len(active), math.nan)
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
    """(A,) [s] mean time from falling behind the group until being back with it.

    A follower is behind while it is not connected, over centres within three diameters (as
    in `splits`), to the largest part of its team's followers, and has farther to go to its
    goal, as the crow flies, than the members of that part have on average. Where several
    parts are the largest, all of them are. A time that lasts until the follower's attempt
    is over counts as long as it lasted. NaN for whoever never fell behind.
    """
    found = analyse(episode)
    place, _, active = found.group_motion
    agents = found.world.agents
    times = np.full(len(active), math.nan)
    for followers, _ in _teams(found):
        if len(followers) > 1:
            away = place[followers] - agents.goal[followers, None]
            left = np.hypot(away[..., 0], away[..., 1])
            lost = behind(place[followers], left, active[followers], agents.radius[followers])
            times[followers] = _mean_run(lost) / FRAME_RATE
    return times


def _teams(found: Analysis) -> Iterator[tuple[IntArray, IntArray]]:
    """Followers and leaders (n,) of every team that has followers."""
    agents = found.world.agents
    for team in np.unique(agents.team):
        followers, leaders = (
            np.flatnonzero((agents.team == team) & (agents.role == int(role)))
            for role in (Role.FOLLOWER, Role.LEADER)
        )
        if len(followers):
            yield followers, leaders


def _way(found: Analysis, agent: int) -> FloatArray:
    """(P, 2) where an agent went, standing left out."""
    t = found.trajectories
    points = t.position[agent, : t.last[agent] + 1]
    step = np.diff(points, axis=0)
    moves = np.hypot(step[:, 0], step[:, 1]) > 0.0
    way: FloatArray = points[np.concatenate([[True], moves])]
    return way


def _mean_run(state: BoolArray) -> FloatArray:
    """(n,) mean length of the runs of True in (n, N); NaN where there is none."""
    begins = state & ~np.pad(state, ((0, 0), (1, 0)))[:, :-1]
    runs = begins.sum(axis=1)
    return np.where(runs > 0, state.sum(axis=1) / np.maximum(runs, 1), math.nan)


@kernel
def mean_lateral(
    place: FloatArray, active: BoolArray, path: FloatArray, first: IntArray
) -> FloatArray:
    """(n,) mean over instants (n, N) of the distance of places (n, N, 2) from the nearest path.

    Path w has the points ``path[first[w]:first[w + 1]]``; see `path_keeping` for what counts.
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
    """Distance to the nearest path; -1 where its nearest point is an end of it."""
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
    """(n, N) True where a member is behind its group, with ``left`` (n, N) [m] to go."""
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
