"""Tracks as episodes, so that the metrics of episodes measure them.

Metrics of an agent take its own time, which begins with its track; metrics of a group take the
time of the table. Therefore there are two episodes: one with all tracks shifted to begin at
time 0, whose contacts and encounters are those at the true times, and one that is not shifted.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from benchnav.arena.world import Afterwards, World
from benchnav.arrays import BoolArray, ByteArray, FloatArray, IntArray
from benchnav.episode.episode import Contacts, Episode, Identity, Status, Timings
from benchnav.kernels import kernel
from benchnav.metrics.quantities.encounters import Encounters
from benchnav.metrics.quantities.episode_analysis import Analysis, analyse, keep
from benchnav.scoring.movers import mover_contacts, mover_positions
from benchnav.scoring.setting import Setting
from benchnav.scoring.touches import TOUCH, touches
from benchnav.scoring.tracks import Tracks


@dataclass(frozen=True, eq=False)
class RecordedEpisode:
    """Two episodes of the same tracks."""

    each: Episode  # every track begins at time 0: for metrics of an agent
    all: Episode  # at the times of the table: for metrics of a group


def recorded_episode(tracks: Tracks, setting: Setting, identity: Identity) -> RecordedEpisode:
    """Return the episodes of tracks in their setting."""
    world = setting.world
    arrival = np.full(len(tracks), np.nan)
    if "goals" in setting.known:
        write_arrivals(
            tracks.place, tracks.first, tracks.last, tracks.end, tracks.dt, world.agents.goal,
            world.rules.goal_tolerance + TOUCH, arrival,
        )  # fmt: skip
    timed_out = "horizon" in setting.known and tracks.place.shape[1] > world.clock.steps
    movers = mover_positions(world.bodies, tracks.place.shape[1], tracks.dt)
    whole = _episode(tracks, world, arrival, identity, timed_out, movers)
    presence = replace(
        analyse(whole).trajectories, enters=tracks.first, leaves=_leaves(tracks, whole)
    )
    together = replace(analyse(whole), trajectories=presence)
    keep(whole, together)
    stop = np.where(np.isnan(arrival), np.inf, arrival)
    contacts = _no_contacts()
    if "radius" in setting.known:
        gone = np.minimum(stop, tracks.end)
        if world.rules.on_arrival == Afterwards.STAY:
            gone = tracks.end
        until = np.minimum(np.ceil(gone / tracks.dt - 1e-9), tracks.last).astype(np.int64)
        radius = world.agents.radius
        contacts = touches(
            tracks.place, tracks.first, until, tracks.dt, gone, radius, world.solids, stop,
            mover_contacts(
                tracks.place, tracks.first, until, tracks.dt, radius, world.bodies, movers
            ),
        )  # fmt: skip
    whole = replace(whole, contacts=contacts)
    keep(whole, replace(together, contacts=contacts))
    begin = tracks.first * tracks.dt
    own = replace(
        contacts, start=contacts.start - begin[contacts.agent],
        end=contacts.end - begin[contacts.agent],
    )  # fmt: skip
    each = replace(
        _episode(tracks.aligned(), world, arrival - begin, identity, timed_out, movers),
        contacts=own,
    )  # with movers, all tracks begin at time 0
    _keep_encounters(each, together, tracks)
    return RecordedEpisode(each, whole)


def _episode(
    tracks: Tracks, world: World, arrival: FloatArray, identity: Identity, timed_out: bool,
    movers: FloatArray,
) -> Episode:  # fmt: skip
    """Return an episode; a track that lasts to the end is active there if it ``timed_out``."""
    states = tracks.place.shape[1]
    times = np.arange(states) * tracks.dt
    over = np.where(np.isnan(arrival), np.inf, arrival)
    status = np.full((states, len(tracks)), int(Status.ACTIVE), np.int8)
    ends = (tracks.last < states - 1) | (not timed_out)
    gone = (np.arange(states)[:, None] >= tracks.last) & ends
    status[gone] = int(Status.ENDED)
    status[times[:, None] >= over - 1e-9] = int(Status.ARRIVED)
    status[-1, np.isfinite(over)] = int(Status.ARRIVED)
    place = np.ascontiguousarray(tracks.place.transpose(1, 0, 2))
    step = np.diff(place, axis=0) / tracks.dt
    heading = np.zeros(place.shape[:2]) if tracks.heading is None else tracks.heading.T
    heading = (heading + math.pi) % (2.0 * math.pi) - math.pi
    return Episode(
        identity=identity, world=world, position=place, heading=heading, status=status,
        requested=step, executed=step, body_position=movers, arrival=arrival,
        contacts=_no_contacts(), timings=Timings(np.zeros(0), 0.0, 1),
    )  # fmt: skip


def _leaves(tracks: Tracks, episode: Episode) -> IntArray:
    """Return the first state (A,) without a body; T+1: never."""
    t, states = analyse(episode).trajectories, tracks.place.shape[1]
    present = np.where(tracks.last < states - 1, tracks.last, states)
    vanish = episode.world.rules.on_arrival == Afterwards.VANISH
    leaves: IntArray = np.where(~np.isnan(episode.arrival) & vanish, t.last, present)
    return leaves


def _keep_encounters(each: Episode, together: Analysis, tracks: Tracks) -> None:
    """Give the encounters at true times to the episode in which each track begins at time 0."""
    found, analysis = together.encounters, analyse(each)
    states = each.position.shape[0]
    at = np.minimum(tracks.first[:, None] + np.arange(states), tracks.place.shape[1] - 1)
    agents = np.arange(len(tracks))[:, None]
    vars(analysis)["encounters"] = Encounters(
        found.clearance, found.time_to_collision, found.gap[agents, at], found.near[agents, at]
    )


def _no_contacts() -> Contacts:
    whole: IntArray = np.zeros(0, np.int64)
    kinds: ByteArray = np.zeros(0, np.int8)
    charged: BoolArray = np.zeros(0, np.bool_)
    nothing = np.zeros(0)
    return Contacts(whole, kinds, whole, nothing, nothing, nothing, nothing, charged)


@kernel
def write_arrivals(
    place: FloatArray, first: IntArray, last: IntArray, end: FloatArray, dt: float,
    goal: FloatArray, tolerance: float, arrival: FloatArray,
) -> None:  # fmt: skip
    """Write when [s] each track (A, T+1, 2) first is within ``tolerance`` [m] of its goal."""
    for a in range(len(place)):
        for k in range(first[a], last[a] + 1):
            px, py = place[a, k, 0] - goal[a, 0], place[a, k, 1] - goal[a, 1]
            if px * px + py * py <= tolerance * tolerance:
                arrival[a] = min(k * dt, end[a])
                break
            if k == last[a]:
                break
            wx, wy = place[a, k + 1, 0] - place[a, k, 0], place[a, k + 1, 1] - place[a, k, 1]
            speed2, closing = wx * wx + wy * wy, px * wx + py * wy
            root = closing * closing - speed2 * (px * px + py * py - tolerance * tolerance)
            if speed2 > 0.0 and closing < 0.0 and root >= 0.0:
                share = (-closing - np.sqrt(root)) / speed2
                if share <= 1.0:
                    arrival[a] = k * dt + share * (min((k + 1) * dt, end[a]) - k * dt)
                    break
