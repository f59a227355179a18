"""The slow reference simulator: all pairs, no grid, no shortcut.

It follows `benchnav.world.step` and the rules of `benchnav.arena.world`, with
different formulas, trigonometry of libm and numpy only, so that it does not repeat a fault of a
kernel. It agrees with the kernels within rounding. Read it to learn what a kernel
must do.
"""

import math

import numpy as np

from benchnav.arena.agents import Dynamics
from benchnav.arena.body import absent
from benchnav.arena.solid import Kind
from benchnav.arena.world import Afterwards, Charge, ContactRule, World
from benchnav.arrays import BoolArray, ByteArray, FloatArray
from benchnav.episode.episode import Status
from benchnav.verify.reference.reference_contacts import MAX_HITS, Event, Ledger, Partner
from benchnav.verify.reference.reference_dynamics import Drive
from benchnav.verify.reference.reference_entry import SOON, admit
from benchnav.verify.reference.reference_footprint import Footprints, difference, touch_time
from benchnav.verify.reference.reference_geometry import (
    first_touch,
    inside,
    law_position,
    nearest,
    unit,
)
from benchnav.verify.reference.reference_touch import Touch, rivals
from benchnav.verify.reference.reference_turning import gap_to, turn
from benchnav.verify.reference.reference_wedging import record_wedged

TIGHT = 1e-6  # [m] wider than any rounding
_NO_AGENTS: Partner = ("goal", 0)


class Twin:
    """One world: state as arrays over its agents (A, …)."""

    def __init__(self, world: World) -> None:
        self.world, self.steps = world, 0
        members = world.agents
        self.position: FloatArray = members.start.copy()
        self.heading: FloatArray = members.heading.copy()
        waits = members.enters > SOON
        self.status: ByteArray = np.where(waits, int(Status.WAITING), 0).astype(np.int8)
        self.velocity = np.zeros((len(members), 2))
        self.arrival = np.full(len(members), math.nan)
        self.hits = np.zeros(len(members), np.int64)
        self.halted = np.zeros(len(members), np.bool_)
        self.placed = [False] * len(world.bodies)
        self.bodies = np.array([law_position(b, 0.0, False) for b in world.bodies]).reshape(-1, 2)
        self.shapes = Footprints(members)
        rest = np.zeros(2)
        self.drives = [Drive(members, i, world.clock.dt, rest) for i in range(len(members))]
        self.ledger = Ledger()
        self.doubtful = False  # rounding may decide the outcome of this decision
        self.touches = 0  # so far
        self._flatten()

    def _flatten(self) -> None:
        """Put all capsules of immobile solids, and of bodies in their frames, in one array each."""
        none = np.zeros((0, 5))
        solids = self.world.solids
        self._fixed = np.vstack([none, *(s.capsules for s in solids)])
        self._solid = [k for k, s in enumerate(solids) for _ in s.capsules]
        carried = [body.solid.capsules for body in self.world.bodies]
        self._carried = np.vstack([none, *carried])
        self.owner = np.array([m for m, c in enumerate(carried) for _ in c], np.int64)

    def capsule(self, p: int) -> FloatArray:
        """Return the capsule (5,) number p of the immobile solids."""
        one: FloatArray = self._fixed[p]
        return one

    def solid_of(self, p: int) -> int:
        """Return the solid of an immobile capsule."""
        return self._solid[p]

    def carried(self, m: int) -> FloatArray:
        """Return the capsules (P, 5) of body m where it is."""
        moved: FloatArray = self._carried[self.owner == m].copy()
        moved[:, :4] += np.tile(self.bodies[m], 2)
        return moved

    def fixed_distance(self, i: int) -> FloatArray:
        """Return the distances (P,) [m] of agent i's centre and the immobile capsules."""
        f = self._fixed
        away = self.position[i] - nearest(self.position[i], f[:, :2], f[:, 2:4])
        apart: FloatArray = np.hypot(*away.T) - f[:, 4]
        return apart

    @property
    def present(self) -> BoolArray:
        """The agents (A,) with a body in the arena."""
        rules = self.world.rules
        gone = self.status == int(Status.WAITING)
        gone |= (self.status == int(Status.ARRIVED)) & (rules.on_arrival == Afterwards.VANISH)
        gone |= (self.status == int(Status.ENDED)) & (rules.on_end == Afterwards.VANISH)
        here: BoolArray = ~gone
        return here

    @property
    def active(self) -> BoolArray:
        """The agents (A,) whose attempt continues."""
        going_on: BoolArray = self.status == int(Status.ACTIVE)
        return going_on

    def step(self, command: FloatArray, twist: BoolArray) -> FloatArray:
        """Step by commands (A, 2), twists where ``twist`` (A,); return the executed commands."""
        clock = self.world.clock
        h = clock.dt / clock.substeps
        self._relocate(self.steps * clock.dt)
        self.halted[:] = False
        self.doubtful = False
        self._turning = (self.world.agents.dynamics != int(Dynamics.HOLONOMIC)) | twist
        drive = np.zeros_like(self.position)
        for i in np.flatnonzero(self.active):
            body = self.drives[i]
            drive[i] = body.executed(command[i], bool(twist[i]), float(self.heading[i]))
            self.doubtful |= body.doubtful
        for s in range(clock.substeps):
            self._substep(drive, (self.steps * clock.substeps + s) * h, h)
        self.steps += 1
        admit(self)
        return drive

    def _relocate(self, time: float) -> None:
        """Relocate obstacles that are due, unless an agent or body is in their circle there."""
        for m, body in enumerate(self.world.bodies):
            moves = body.solid.kind == Kind.STATIC and not self.placed[m]
            if not moves or time < body.law.times[-1]:
                continue
            there, bound = body.law.points[-1], body.solid.bounding_radius
            away = np.hypot(*(self.position - there).T) - self.world.agents.radius - bound
            others = [
                np.hypot(*(self.bodies[k] - there)) - bound - other.solid.bounding_radius
                for k, other in enumerate(self.world.bodies)
                if other.solid.kind != Kind.STATIC
            ]
            if not (away[self.present] < 0.0).any() and not (np.array(others) < 0.0).any():
                self.placed[m] = True
                self.bodies[m] = there

    def _substep(self, drive: FloatArray, begin: float, h: float) -> None:
        self.hits[:] = 0
        moving = self.active & ~self.halted
        self.velocity = np.where(moving[:, None], drive, 0.0)
        for i in np.flatnonzero(moving & self._turning):
            angle = self.heading[i] + 0.5 * drive[i, 1] * h
            self.velocity[i] = drive[i, 0] * np.array([math.cos(angle), math.sin(angle)])
        goals = [
            law_position(b, begin + h, self.placed[m]) for m, b in enumerate(self.world.bodies)
        ]
        target = np.array(goals).reshape(-1, 2)
        jumps = absent(target) != absent(self.bodies)
        self.carry = np.where(jumps[:, None], 0.0, (target - self.bodies) / h)
        left = h
        while (touch := self._earliest()) is not None and touch.time <= left:
            self._drift(touch.time)
            left -= touch.time
            self._meet(touch, begin + h - left)
            record_wedged(self, begin + h - left, left)
        self._drift(left)
        self.bodies = target
        self._turn(drive, begin + h, h)
        self._follow_up(begin + h)

    def _drift(self, time: float) -> None:
        self.position = self.position + self.velocity * time
        self.bodies = self.bodies + self.carry * time

    def _turn(self, drive: FloatArray, time: float, h: float) -> None:
        for i in np.flatnonzero(self.active):
            if self.shapes.shaped[i]:
                if self.active[i]:  # an earlier turn may have ended its attempt
                    self._turn_shape(int(i), drive[i], time, h)
            elif self._turning[i]:
                self.heading[i] += drive[i, 1] * h
            elif drive[i].any():
                self.heading[i] = math.atan2(drive[i, 1], drive[i, 0])

    def _turn_shape(self, i: int, drive: FloatArray, time: float, h: float) -> None:
        angle = drive[1] * h
        if not self._turning[i]:
            most = float(self.world.agents.max_turn_rate[i]) * h
            aim = math.atan2(drive[1], drive[0]) - self.heading[i] if drive.any() else 0.0
            angle = min(max(math.remainder(aim, 2.0 * math.pi), -most), most)
        if angle != 0.0:
            turn(self, i, angle, time, h)

    def _earliest(self) -> Touch | None:
        """Return the next touch; of simultaneous touches that of the first agent."""
        agents = np.flatnonzero(self.active & (self.hits < MAX_HITS))
        if len(agents) == 0:
            return None
        found = self._touches(agents)
        best = min(found, key=lambda touch: (touch.time, touch.agent))
        if self.hits.max() > MAX_HITS // 2 or rivals(best, found):
            self.doubtful = True
        return best if best.time < math.inf else None

    def touch_times(self, agents: np.ndarray) -> tuple[FloatArray, ...]:
        """Return times [s] until ``agents`` (N,) touch the goal, capsules, bodies' ones, agents."""
        world, r = self.world, self.world.agents.radius
        p, v = self.position[agents][:, None], self.velocity[agents][:, None]
        goal, tolerance = world.agents.goal[agents][:, None], world.rules.goal_tolerance
        f, c, zero = self._fixed, self._carried, np.zeros((len(r), 2))
        at, carry = self.bodies[self.owner], self.carry[self.owner]
        # partners are the goal, solids, bodies and agents: one call for all of them is faster
        place, moved = (
            np.concatenate([own, own - np.zeros_like(f[:, :2]), own - bodies, own - others], axis=1)
            for own, bodies, others in ((p, at, self.position), (v, carry, self.velocity))
        )
        many = len(agents)
        first, second = (
            np.concatenate([goal, *(np.broadcast_to(e, (many, *e.shape)) for e in ends)], axis=1)
            for ends in ((f[:, :2], c[:, :2], zero), (f[:, 2:4], c[:, 2:4], zero))
        )
        reach = r[agents][:, None] + np.concatenate([f[:, 4], c[:, 4], r])
        reach = np.concatenate([np.full((many, 1), tolerance), reach], axis=1)
        times = first_touch(place, moved, first, second, reach)
        home, fixed, bodies, others = np.split(times, np.cumsum([1, len(f), len(c)]), axis=1)
        away = np.hypot(*(p - goal)[:, 0].T)
        home = np.where(away <= tolerance, 0.0, home[:, 0])
        others[np.arange(many), agents] = math.inf
        others[:, ~self.present] = math.inf
        self._refine(agents, fixed, bodies, others)
        return home, fixed, bodies, others

    def _touches(self, agents: np.ndarray) -> list[Touch]:
        """Return the first touch of each of ``agents`` (N,), by the order of rules for ties."""
        home, fixed, bodies, others = self.touch_times(agents)
        found = []
        for row, i in enumerate(agents):
            touch = Touch(float(home[row]), int(i), _NO_AGENTS)
            for name, times in (("solid", fixed), ("body", bodies), ("agent", others)):
                k = int(np.argmin(times[row])) if times.shape[1] else -1
                if k >= 0 and times[row, k] < touch.time:
                    touch = self._named(name, k, float(times[row, k]), int(i))
            found.append(touch)
        return found

    def _refine(
        self, agents: np.ndarray, fixed: FloatArray, bodies: FloatArray, others: FloatArray
    ) -> None:
        """Replace the times (N, …) of circles by those of bodies that are not discs."""
        h = self.world.clock.dt / self.world.clock.substeps
        shapes, radius = self.shapes, self.world.agents.radius
        for row, i in enumerate(agents):
            core = shapes.core(int(i), float(self.heading[i]))
            p, v = self.position[i], self.velocity[i]
            if shapes.shaped[i]:
                near = self.fixed_distance(int(i)) < radius[i] + math.hypot(*v) * h + TIGHT
                fixed[row] = math.inf
                for k in np.flatnonzero(near):
                    c = self._fixed[k]
                    hull = difference(core, c[:4].reshape(2, 2))
                    fixed[row, k] = touch_time(p, v, hull, float(c[4] + shapes.rounding[i]))
                for q, c in enumerate(self._carried):
                    m = self.owner[q]
                    hull = difference(core, c[:4].reshape(2, 2))
                    reach = float(c[4] + shapes.rounding[i])
                    moved = p - self.bodies[m], v - self.carry[m]
                    bodies[row, q] = touch_time(*moved, hull, reach)
            pairs = self.present & (shapes.shaped | shapes.shaped[i])
            for j in np.flatnonzero(pairs):
                if j == i:
                    continue
                w = v - self.velocity[j]
                apart = math.hypot(*(p - self.position[j]))
                others[row, j] = math.inf
                if apart <= radius[i] + radius[j] + math.hypot(*w) * h + TIGHT:
                    hull = difference(core, shapes.core(int(j), float(self.heading[j])))
                    reach = float(shapes.rounding[i] + shapes.rounding[j])
                    others[row, j] = touch_time(p - self.position[j], w, hull, reach)

    def _named(self, name: str, k: int, time: float, i: int) -> Touch:
        if name == "solid":
            return Touch(time, i, (name, self._solid[k]), k)
        return Touch(time, i, (name, int(self.owner[k]) if name == "body" else k))

    def _meet(self, touch: Touch, time: float) -> None:
        self.touches += 1
        i, (name, k) = touch.agent, touch.partner
        if name == "goal":
            self.arrival[i] = time
            self._finish(i, Status.ARRIVED, time)
            return
        self.hits[i] += 1
        if name == "agent":
            self._meet_agent(i, k, time)
            return
        away, carried = self.away(i, name, k, touch.capsule)
        normal = unit(away)
        closing = float((carried - self.velocity[i]) @ normal)
        self.ledger.record(i, touch.partner, time, closing, True)
        self.respond(i, normal, closing, time)

    def away(self, i: int, name: str, k: int, capsule: int) -> tuple[FloatArray, FloatArray]:
        """Return (vector from the partner's nearest point to agent i, the partner's velocity)."""
        if name == "solid":
            c = self._fixed[capsule]
            if self.shapes.shaped[i]:
                return gap_to(self, i, (("solid", capsule), capsule))[0], np.zeros(2)
            return self.position[i] - nearest(self.position[i], c[:2], c[2:4]), np.zeros(2)
        if self.shapes.shaped[i]:
            return gap_to(self, i, (("body", k), -1))[0], self.carry[k]
        shapes = self._carried[self.owner == k]
        local = self.position[i] - self.bodies[k]
        away = local - nearest(local, shapes[:, :2], shapes[:, 2:4])
        gap = np.hypot(*away.T) - shapes[:, 4]
        return away[int(np.argmin(gap))], self.carry[k]

    def _meet_agent(self, i: int, j: int, time: float) -> None:
        """Remove each agent's own motion towards the other."""
        self.hits[j] += 1
        normal = unit(self.position[i] - self.position[j])
        if self.shapes.shaped[i] or self.shapes.shaped[j]:
            normal = gap_to(self, i, (("agent", j), -1))[0]
        own, other = float(self.velocity[i] @ normal), float(self.velocity[j] @ normal)
        active = bool(self.active[j])
        self.ledger.record(i, ("agent", j), time, other - own, True)
        charged = active or self.world.rules.charge == Charge.BOTH
        self.ledger.record(j, ("agent", i), time, other - own, charged)
        if active:
            self.respond(j, -normal, max(other - max(own, 0.0), 0.0), time)
        self.respond(i, normal, max(min(other, 0.0) - own, 0.0), time)

    def respond(self, i: int, normal: FloatArray, give: float, time: float) -> None:
        """Apply the contact rule to agent i; SLIDE adds ``give`` [m/s] along the normal."""
        rule = self.world.rules.contact
        if rule == ContactRule.END:
            self._finish(i, Status.ENDED, time)
        elif rule == ContactRule.STOP or self.hits[i] >= MAX_HITS:
            self.velocity[i] = 0.0
            self.halted[i] |= rule == ContactRule.STOP
        else:
            self.velocity[i] += give * normal

    def _finish(self, i: int, status: Status, time: float) -> None:
        self.status[i] = int(status)
        self.velocity[i] = 0.0
        self.ledger.close_all(i, time)

    def _follow_up(self, time: float) -> None:
        present = self.present
        for event in list(self.ledger.opened.values()):
            gap = self.gap(event) if present[event.agent] else math.inf
            self.ledger.follow_up(event, gap, time)

    def gap(self, event: Event) -> float:
        """Return the current gap [m] of an event's partners; negative: overlap; inf: one left."""
        i, (name, k) = event.agent, event.partner
        p, r = self.position[i], float(self.world.agents.radius[i])
        if name == "agent":
            if not self.present[k]:
                return math.inf
            if self.shapes.shaped[i] or self.shapes.shaped[k]:
                return gap_to(self, i, (("agent", k), -1))[1]
            return math.hypot(*(p - self.position[k])) - r - float(self.world.agents.radius[k])
        solid = self.world.solids[k] if name == "solid" else self.world.bodies[k].solid
        local = p if name == "solid" else p - self.bodies[k]
        c = solid.capsules
        if self.shapes.shaped[i]:
            return self._shape_gap(i, name, k, local)
        away = local - nearest(local, c[:, :2], c[:, 2:4])
        gap = float((np.hypot(*away.T) - c[:, 4]).min()) - r
        within = name == "body" and not solid.is_disc and inside(local, solid.loops)
        return -gap - 2.0 * r if within else gap

    def _shape_gap(self, i: int, name: str, k: int, local: FloatArray) -> float:
        """Return the gap [m] of a body that is not a disc, with its centre at ``local`` (2,)."""
        if name == "solid":
            numbers = [p for p, solid in enumerate(self._solid) if solid == k]
            return min(gap_to(self, i, (("solid", p), p))[1] for p in numbers)
        solid = self.world.bodies[k].solid
        if solid.is_disc or not inside(local, solid.loops):
            return gap_to(self, i, (("body", k), -1))[1]
        c = solid.capsules
        away = local - nearest(local, c[:, :2], c[:, 2:4])
        apart = np.hypot(*away.T)
        core = self.shapes.core(i, float(self.heading[i]))
        extent = (core @ (away / np.where(apart > 0.0, apart, 1.0)[:, None]).T).max(axis=0)
        return -float((apart + extent).min()) - float(self.shapes.rounding[i])
