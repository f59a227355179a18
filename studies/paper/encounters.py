"""Fig. 8: what an agent does where a collision with a mover is predicted."""

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from benchnav.arena.solid import Kind
from benchnav.arrays import FloatArray, IntArray
from benchnav.envs.collision_probability import probability
from benchnav.episode.episode import Episode, Status

THRESHOLD = 0.6  # T_c of Table 1
REACH = 10  # decisions before and after the closest approach that are kept
AHEAD = 15  # decisions after an alarm in which the closest approach is looked for
SPEED, TURN = 0.2, float(np.radians(15.0))  # [m/s], [rad] changes that count as such


@dataclass(frozen=True, eq=False)
class Encounter:
    """One agent and one mover, around their closest approach after an alarm."""

    seed: int
    agent: int
    body: int
    alarm: int  # decision at which the probability exceeded the threshold
    closest: int  # state of the closest approach after it
    gap: float  # [m] then, between the agent and the mover's circumscribed circle
    hit: bool
    speed: FloatArray  # (2 · REACH,) [m/s] from REACH decisions before the closest approach on
    turn: FloatArray  # (2 · REACH,) [rad] of the heading since the alarm

    @property
    def sped(self) -> float:
        """[m/s] greatest change of speed from the alarm to the closest approach, signed."""
        during = self._during(self.speed)
        high, low = float(during.max() - during[0]), float(during.min() - during[0])
        return high if high > -low else low

    @property
    def turned(self) -> float:
        """[rad] greatest change of heading from the alarm to the closest approach."""
        return float(np.abs(self._during(self.turn)).max())

    def _during(self, series: FloatArray) -> FloatArray:
        first = max(0, REACH - (self.closest - self.alarm))
        during = series[first : REACH + 1]
        during = during[np.isfinite(during)]
        return during if len(during) else np.zeros(1)


@dataclass(frozen=True, eq=False)
class Behaviour:
    """Of one navigator in many worlds."""

    encounters: list[Encounter]
    speed: tuple[float, float]  # [m/s] mean without and with an alarm
    turning: tuple[float, float]  # [rad/s] mean |turn rate| without and with an alarm


def behaviour(episodes: Iterable[Episode]) -> Behaviour:
    """Every predicted collision with a mover, and what is different then."""
    found: list[Encounter] = []
    samples: list[FloatArray] = []  # (3, N) each: alarm, speed, |turn rate|
    for episode in episodes:
        for a in map(int, np.flatnonzero(episode.world.agents.evaluated)):
            own, sample = _of_agent(episode, a)
            found += own
            samples.append(sample)
    alarm, speed, turning = np.concatenate(samples, axis=1)
    when = (alarm == 0.0, alarm > 0.0)
    return Behaviour(
        found,
        (_mean(speed[when[0]]), _mean(speed[when[1]])),
        (_mean(turning[when[0]]), _mean(turning[when[1]])),
    )


def _mean(values: FloatArray) -> float:
    return float(values.mean()) if len(values) else math.nan


def _of_agent(episode: Episode, a: int) -> tuple[list[Encounter], FloatArray]:
    dt, taken = episode.world.clock.dt, int((episode.status[:-1, a] == Status.ACTIVE).sum())
    position, heading = episode.position[: taken + 1, a], episode.heading[: taken + 1, a]
    velocity = np.diff(position, axis=0) / dt
    found: list[Encounter] = []
    alarmed = np.zeros(taken)
    for m, body in enumerate(episode.world.bodies):
        if body.solid.kind != Kind.DYNAMIC:
            continue
        place = episode.body_position[: taken + 1, m]
        reach = float(episode.world.agents.radius[a]) + body.solid.bounding_radius
        apart, closing = place - position, velocity - np.diff(place, axis=0) / dt
        alarm = np.zeros(taken, np.bool_)
        for k in range(1, taken):  # the velocity that is seen at k is that of the step before
            x, y, vx, vy = map(float, (*apart[k], *closing[k - 1]))
            alarm[k] = probability(x, y, vx, vy, reach) > THRESHOLD
        alarmed[alarm] = 1.0
        gap = np.hypot(*apart.T) - reach
        found += _encounters(episode, a, m, np.flatnonzero(alarm), gap)
    turn_rate = np.abs(np.diff(np.unwrap(heading))) / dt
    return found, np.stack([alarmed, np.hypot(*velocity.T), turn_rate])


def _encounters(
    episode: Episode, a: int, m: int, alarms: IntArray, gap: FloatArray
) -> list[Encounter]:
    """One for each stretch of alarms; two seconds after its closest approach a new one begins."""
    taken, dt = len(gap) - 1, episode.world.clock.dt
    heading = np.unwrap(episode.heading[: taken + 1, a])
    speed = np.hypot(*np.diff(episode.position[: taken + 1, a], axis=0).T) / dt
    found: list[Encounter] = []
    until = -1
    for alarm in map(int, alarms):
        if alarm <= until:
            continue
        closest = alarm + int(gap[alarm : alarm + AHEAD].argmin())
        until = closest + REACH
        found.append(
            Encounter(
                episode.identity.seed, a, m, alarm, closest, float(gap[closest]),
                _hit(episode, a, m, alarm * dt, until * dt),
                _around(speed, closest), _around(heading - heading[alarm], closest),
            )
        )  # fmt: skip
    return found


def _around(series: FloatArray, middle: int) -> FloatArray:
    at = middle + np.arange(-REACH, REACH)
    inside = (at >= 0) & (at < len(series))
    return np.where(inside, series[np.clip(at, 0, len(series) - 1)], np.nan)


def _hit(episode: Episode, a: int, m: int, first: float, last: float) -> bool:
    c = episode.contacts
    mine = (c.agent == a) & (c.kind == int(Kind.DYNAMIC)) & (c.partner == -1 - m)
    return bool((mine & (c.start >= first) & (c.start <= last)).any())
