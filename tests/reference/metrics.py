"""Slow twins of the kernels of metrics, in plain numpy: they return the same bits."""

import math

import numpy as np

from benchnav.arena.world import ContactRule
from benchnav.episode.episode import Status
from benchnav.metrics.quantities.episode_analysis import analyse
from benchnav.metrics.quantities.lowpass import LEAD, RATE, TAPS


def cut(episode):
    """(last, end, position, duration, velocity, length) of `cut_paths`."""
    dt, states = episode.world.clock.dt, len(episode.position)
    over = ~np.isin(episode.status, (int(Status.ACTIVE), int(Status.WAITING)))
    last = np.where(over.any(axis=0), over.argmax(axis=0), states - 1)
    waits = (episode.status == int(Status.WAITING)).T
    until = np.minimum(np.arange(states), last[:, None])
    position = np.take_along_axis(episode.position.transpose(1, 0, 2), until[..., None], axis=1)
    before = np.maximum(last - 1, 0) * dt
    within = (episode.status[-1] == int(Status.ARRIVED)) & (episode.arrival >= before - 1e-9)
    end = np.where(within, np.fmin(episode.arrival, last * dt), last * dt)
    duration = np.diff(np.minimum(np.arange(states) * dt, end[:, None]), axis=1)
    duration[waits[:, :-1]] = 0.0
    segment = np.diff(np.ascontiguousarray(position), axis=1)
    slow = duration < 1e-9
    velocity = np.where(slow[..., None], 0.0, segment / np.where(slow, 1.0, duration)[..., None])
    length = np.hypot(segment[..., 0], segment[..., 1]).sum(axis=1)
    return last, end, position, duration, velocity, length


def positions_at(t, times):
    steps = t.duration.shape[1]
    k = np.clip((times / t.dt + 1e-9).astype(np.int64), 0, steps - 1)
    elapsed = np.minimum(times[None] - k * t.dt, t.duration[:, k])
    return t.position[:, k] + t.velocity[:, k] * elapsed[..., None]


def _over(parts, total):
    return np.where(total > 0.0, parts.sum(axis=1) / np.where(total > 0.0, total, 1.0), math.nan)


def jam(episode):
    found = analyse(episode)
    t = found.trajectories
    slow = t.speed < 0.2 * episode.world.agents.preferred_speed[:, None]
    return _over((slow & found.encounters.near[:, :-1]) * t.duration, t.duration.sum(axis=1))


def share_within(episode, distance):
    found = analyse(episode)
    gap, duration = found.encounters.gap - distance, found.trajectories.duration
    before, after = gap[:, :-1], gap[:, 1:]
    inside = np.where((before < 0.0) & (after < 0.0), 1.0, 0.0)
    crosses = (before < 0.0) != (after < 0.0)
    deeper = np.minimum(before, after)
    share = np.where(crosses, deeper / np.where(crosses, -np.abs(after - before), 1.0), inside)
    return _over(share * duration, duration.sum(axis=1))


def contact_time(episode):
    c, total = episode.contacts, np.zeros(len(episode.world.agents))
    if episode.world.rules.contact == ContactRule.END:
        return np.full_like(total, np.nan)
    reached = np.zeros(len(total))
    for n in np.flatnonzero(c.charged)[np.argsort(c.start[c.charged], kind="stable")]:
        a = c.agent[n]
        total[a] += max(0.0, c.end[n] - max(c.start[n], reached[a]))
        reached[a] = max(reached[a], c.end[n])
    return total


def turning(episode):
    found = analyse(episode)
    t = found.trajectories
    segment = np.diff(t.position, axis=1)
    has = np.hypot(segment[..., 0], segment[..., 1]) > 1e-6
    latest = np.maximum.accumulate(np.where(has, np.arange(has.shape[1]), -1), axis=1)
    angle = np.arctan2(segment[..., 1], segment[..., 0])
    held = np.take_along_axis(angle, np.maximum(latest, 0), axis=1)
    change = np.diff(held, axis=1)
    change = np.abs(np.remainder(change + math.pi, 2.0 * math.pi) - math.pi)
    total = np.where(latest[:, :-1] >= 0, change, 0.0).sum(axis=1)
    defined = found.arrived & t.moved
    return np.where(defined, total / np.where(defined, t.length, 1.0), math.nan)


def smooth_velocity(t, agent):
    first, last = 0 if t.enters is None else int(t.enters[agent]), int(t.last[agent])
    begin, end = first * t.dt, float(t.end[agent])
    middle = np.arange(first, last) * t.dt + 0.5 * t.duration[agent, first:last]
    times = np.arange(int((end - begin) * RATE + 1e-9) + 1) / RATE + begin
    samples = np.zeros((2, len(times) + 3 * LEAD))
    for axis in range(2):
        raw = np.interp(times, middle, t.velocity[agent, first:last, axis])
        samples[axis, 2 * LEAD : 2 * LEAD + len(times)] = raw
        samples[axis, 2 * LEAD + len(times) :] = raw[-1]
    return np.stack([np.convolve(axis, TAPS, mode="valid") for axis in samples], axis=1)


def dimensionless_jerk(velocity, duration, rate):
    jerk = np.diff(velocity, n=2, axis=0) * rate**2
    peak2 = float((velocity**2).sum(axis=1).max())
    return float((jerk**2).sum()) / rate * duration**3 / peak2


def spectral_arc_length(speed, rate, top=1.0):
    size = 2 ** (math.ceil(math.log2(len(speed))) + 4)
    count = int(top / (rate / size)) + 1
    spectrum = np.abs(np.fft.rfft(speed, size))
    spectrum = spectrum[:count] / spectrum.max()
    band = np.flatnonzero(spectrum >= 0.05)
    spectrum = spectrum[band[0] : band[-1] + 1] if len(band) else spectrum[:0]
    if len(spectrum) < 2:
        return math.nan
    rise = np.diff(spectrum)
    return -float(np.sqrt((1.0 / len(rise)) ** 2 + rise**2).sum())


def spreads(place, active, radius):
    share = active / active.sum(axis=0)
    away = place - (place * share[..., None]).sum(axis=0)
    distance = (np.hypot(away[..., 0], away[..., 1]) * share).sum(axis=0)
    mean_radius = (radius[:, None] * share).sum(axis=0)
    packed = np.sqrt(active.sum(axis=0) * math.sqrt(12.0) / math.pi)
    return distance / (2.0 / 3.0 * mean_radius * packed)


def orders(step, active):
    length = np.hypot(step[..., 0], step[..., 1])
    moving = active & (length > 1e-9)
    unit = np.where(moving, 1.0 / np.where(moving, length, 1.0), 0.0)[..., None] * step
    count = moving.sum(axis=0)
    order = np.hypot(*unit.sum(axis=0).T) / np.maximum(count, 1)
    return np.where(count > 0, order, math.nan)
