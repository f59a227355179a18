"""One decision of one world, slowly: every pair, no grid, no early rejection, plain objects.

Written from the description in benchnav/world/step.py and the rules in arena/world.py,
with trigonometry from `math`; compared within rounding, not bit for bit.
"""

import math
from dataclasses import dataclass, field

import numpy as np

from benchnav.arena.agents import Dynamics
from benchnav.arena.body import LawKind
from benchnav.arena.world import Afterwards, ContactRule


@dataclass
class Agent:
    p: np.ndarray
    heading: float
    v: np.ndarray = field(default_factory=lambda: np.zeros(2))
    status: str = "active"
    present: bool = True
    hits: int = 0
    halted: bool = False


def law_position(law, time):
    if law.kind == LawKind.CIRCLE:
        angle = law.points[1, 1] + law.times[0] * time
        return law.points[0] + law.points[1, 0] * np.array([math.cos(angle), math.sin(angle)])
    t = time + law.phase
    if law.periodic:
        t = t % law.times[-1]
    return np.array([np.interp(t, law.times, law.points[:, k]) for k in range(2)])


def touch_times(p, v, capsule, reach):
    """Candidate times: both offset lines and both end circles, each checked for being first."""
    a, b = capsule[:2], capsule[2:4]
    d = b - a
    length = np.hypot(*d)
    times = []
    for end in (a, b):
        f = p - end
        q = (v @ v, 2 * f @ v, f @ f - reach**2)
        if q[0] > 0 and q[1] ** 2 - 4 * q[0] * q[2] >= 0:
            times += [
                (-q[1] + s * math.sqrt(q[1] ** 2 - 4 * q[0] * q[2])) / (2 * q[0]) for s in (-1, 1)
            ]
    if length > 0:
        n = np.array([-d[1], d[0]]) / length
        if v @ n != 0:
            for side in (-1, 1):
                t = (side * reach - (p - a) @ n) / (v @ n)
                if 0 <= (p + v * t - a) @ d / length**2 <= 1:
                    times.append(t)
    return times


def nearest(p, capsule):
    a, b = capsule[:2], capsule[2:4]
    d = b - a
    u = np.clip((p - a) @ d / (d @ d), 0, 1) if d @ d > 0 else 0.0
    return a + u * d


def first_touch(p, v, capsule, reach):
    offset = p - nearest(p, capsule)
    if offset @ v >= -1e-9 * reach:
        return math.inf
    if np.hypot(*offset) <= reach + 1e-12:  # touching, but for rounding
        return 0.0
    return min((t for t in touch_times(p, v, capsule, reach) if t >= 0), default=math.inf)


class SlowWorld:
    """Steps a World; contacts rule SLIDE, STOP and END; holonomic and unicycle."""

    def __init__(self, world):
        self.world, self.steps = world, 0
        crew = world.agents
        self.agents = [Agent(crew.start[i].copy(), crew.heading[i]) for i in range(len(crew))]
        self.events = []  # (time, agent, partner) of every touch

    def step(self, command, twist):
        world, crew = self.world, self.world.agents
        clock = world.clock
        self.turning = [d == Dynamics.UNICYCLE or twist for d in crew.dynamics]
        h = clock.dt / clock.substeps
        drive = [self._limit(i, command[i], twist) for i in range(len(crew))]
        for agent in self.agents:
            agent.halted = False
        for s in range(clock.substeps):
            tick = self.steps * clock.substeps + s
            self._substep(drive, tick * h, h)
        self.steps += 1

    def _limit(self, i, c, twist):
        crew, heading = self.world.agents, self.agents[i].heading
        dt, top, turn = self.world.clock.dt, crew.max_speed[i], crew.max_turn_rate[i]
        if crew.dynamics[i] == Dynamics.UNICYCLE or twist:
            v, w = c
            if not twist:
                ahead = math.cos(heading) * c[0] + math.sin(heading) * c[1]
                aside = math.cos(heading) * c[1] - math.sin(heading) * c[0]
                v, w = max(0.0, ahead), math.atan2(aside, ahead) / dt
            return np.array([np.clip(v, 0, top), np.clip(w, -turn, turn)])
        speed = np.hypot(*c)
        return np.asarray(c) * (min(1.0, top / speed) if speed > 0 else 1.0)

    def _substep(self, drive, begin, h):
        world = self.world
        for i, agent in enumerate(self.agents):
            agent.hits, agent.v = 0, np.zeros(2)
            if agent.status == "active" and not agent.halted:
                agent.v = np.array(drive[i])
                if self.turning[i]:
                    angle = agent.heading + drive[i][1] * h / 2
                    agent.v = drive[i][0] * np.array([math.cos(angle), math.sin(angle)])
        bodies = [law_position(body.law, begin) for body in world.bodies]
        moves = [
            (law_position(body.law, begin + h) - p) / h
            for body, p in zip(world.bodies, bodies, strict=True)
        ]
        left = h
        while True:
            time, i, partner = self._earliest(bodies, moves)
            if not time <= left:
                break
            for agent in self.agents:
                agent.p = agent.p + agent.v * time
            bodies = [p + v * time for p, v in zip(bodies, moves, strict=True)]
            left -= time
            self._touch(i, partner, begin + h - left, bodies, moves)
        for i, agent in enumerate(self.agents):
            agent.p = agent.p + agent.v * left
            if agent.status == "active" and agent.present:
                if self.turning[i]:
                    agent.heading += drive[i][1] * h
                elif drive[i].any():
                    agent.heading = math.atan2(drive[i][1], drive[i][0])

    def _earliest(self, bodies, moves):
        best = (math.inf, -1, None)
        for i in range(len(self.agents)):
            time, partner = self._next(i, bodies, moves)
            if time < best[0]:
                best = (time, i, partner)
        return best

    def _next(self, i, bodies, moves):
        """(time, partner) of the next touch of agent i; the goal wins ties, then solids, …"""
        world, crew, agent = self.world, self.world.agents, self.agents[i]
        if agent.status != "active" or agent.hits >= 8:
            return math.inf, None
        tolerance, r = world.rules.goal_tolerance, crew.radius[i]
        goal = np.concatenate([crew.goal[i], crew.goal[i]])
        inside = np.hypot(*(agent.p - crew.goal[i])) <= tolerance
        found = [(0.0 if inside else first_touch(agent.p, agent.v, goal, tolerance), ("goal", 0))]
        for k, solid in enumerate(world.solids):
            found += [
                (first_touch(agent.p, agent.v, c, r + c[4]), ("solid", k, c))
                for c in solid.capsules
            ]
        for m, body in enumerate(world.bodies):
            for c in body.solid.capsules:
                relative = agent.v - moves[m]
                found.append((first_touch(agent.p - bodies[m], relative, c, r + c[4]), ("body", m)))
        for j, other in enumerate(self.agents):
            if j != i and other.present:
                point = np.concatenate([other.p, other.p])
                t = first_touch(agent.p, agent.v - other.v, point, r + crew.radius[j])
                found.append((t, ("agent", j)))
        return min(found, key=lambda item: item[0])

    def _touch(self, i, partner, time, bodies, moves):
        world, agent = self.world, self.agents[i]
        self.events.append((time, i, partner[:2]))
        if partner[0] == "goal":
            agent.status, agent.v = "arrived", np.zeros(2)
            agent.present = world.rules.on_arrival != Afterwards.VANISH
            return
        agent.hits += 1
        if partner[0] == "agent":
            self._touch_agent(i, partner[1])
            return
        if partner[0] == "solid":
            n, u = agent.p - nearest(agent.p, partner[2]), np.zeros(2)
        else:
            m = partner[1]
            local = agent.p - bodies[m]
            cores = [nearest(local, c) for c in world.bodies[m].solid.capsules]
            n, u = min((local - q for q in cores), key=lambda d: np.hypot(*d)), moves[m]
        n = n / np.hypot(*n)
        self._respond(agent, n, (u - agent.v) @ n)

    def _touch_agent(self, i, j):
        a, b = self.agents[i], self.agents[j]
        b.hits += 1
        n = (a.p - b.p) / np.hypot(*(a.p - b.p))
        own, other = a.v @ n, b.v @ n
        if b.status == "active":
            self._respond(b, -n, max(other - max(own, 0.0), 0.0))
        self._respond(a, n, max(min(other, 0.0) - own, 0.0))

    def _respond(self, agent, n, give):
        rule = self.world.rules.contact
        if rule == ContactRule.END:
            agent.status, agent.v = "ended", np.zeros(2)
            agent.present = self.world.rules.on_end != Afterwards.VANISH
        elif rule == ContactRule.STOP or agent.hits >= 8:
            agent.v, agent.halted = np.zeros(2), agent.halted or rule == ContactRule.STOP
        else:
            agent.v = agent.v + give * n
