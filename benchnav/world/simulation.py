"""The simulation of a batch of worlds."""

from collections.abc import Sequence

import numpy as np

from benchnav.arena.agents import Agents, Dynamics
from benchnav.arena.solid import Kind
from benchnav.arena.world import Afterwards, Charge, World
from benchnav.arrays import AnyArray, BoolArray, ByteArray, FloatArray, IntArray
from benchnav.episode.episode import Contacts, Status
from benchnav.geometry.hash_grid import hash_table
from benchnav.threads import run_rows
from benchnav.world.bodies import stack_bodies, start_bodies, top_speeds
from benchnav.world.contacts import RELEASE
from benchnav.world.entry import SOON, queue
from benchnav.world.fixed import stack_fixed
from benchnav.world.motion_limits import limit_records
from benchnav.world.records import AGENT as AGENT_RECORD
from benchnav.world.records import CONTACT, LIMITS, LISTED, OPEN_CONTACTS, SPOT, WORLD, field
from benchnav.world.step import step_worlds
from benchnav.world.touch import AGENT, BODY, BRUTE_FORCE


class Simulation:
    """State of B worlds of up to A agents and M bodies; padding is never `present`.

    All worlds of a batch share one clock and one set of rules. `records` and the
    views below are the live state: copy values that must not change.
    """

    def __init__(self, worlds: Sequence[World]) -> None:
        self.worlds = tuple(worlds)
        first = self.worlds[0]
        if any(w.clock != first.clock or w.rules != first.rules for w in self.worlds):
            raise ValueError("The worlds of a batch must share their clock and rules.")
        self.agents = _agent_records(self.worlds)
        self.bodies, self.shapes, self.knots = stack_bodies(self.worlds)
        self.limits = _limit_records(self.worlds, self.A)
        self.records = _world_records(self.worlds, self.agents, self.bodies, self.knots)
        # wider lists change nothing: an object out of reach is never the next touch
        margin = float((0.5 * self.records["reach"]).max()) + RELEASE
        self.capsules, self.start, self.item = stack_fixed(self.worlds, self.records, margin)
        self.widest_disc = float(self.capsules["r"].max(initial=0.0))  # [m] of the fixed solids
        self._opened = np.zeros((self.B, self.A, OPEN_CONTACTS), CONTACT)
        self._opened["code"] = -1
        room = 32 + 2 * OPEN_CONTACTS * self.A * (first.clock.substeps + 1)
        self.shaped = bool(self.records["shaped"].any())  # some bodies are not discs
        room *= 2 if self.shaped else 1  # turns have contacts of their own
        self._closed = np.zeros((self.B, room), CONTACT)
        self._kept: list[list[AnyArray]] = [[] for _ in self.worlds]
        self.hashed = hash_table(self.B, self.A)
        self.spots = np.zeros((self.B, self.A), SPOT)
        crowd = self.A if self.A > BRUTE_FORCE else 0
        # of each agent: a number, and as many spots, nearest first; all others are beyond `beyond`
        self.listed = np.zeros((self.B, crowd, 1 + LISTED), np.int32)
        self.beyond = np.full((self.B, crowd), -1.0)  # [m]; negative: there is no list
        self.sees = _sees(self.worlds)
        self.widest = float(self.agents["radius"].max())  # [m]
        # [m] from each agent to the farthest neighbour last found: a hint for the next search
        self.near = np.full((self.B, self.A), 4.0 * self.widest)
        self.most_shapes = int((self.bodies["last"] - self.bodies["first"]).sum(1).max())
        self._views()
        start_bodies(self.bodies, self.records["bodies"], self.knots, self.records["h"])

    def _views(self) -> None:
        agents, bodies, records = self.agents, self.bodies, self.records
        self.position: FloatArray = field(agents, "x", 2)  # (B, A, 2) [m]
        self.velocity: FloatArray = field(agents, "vx", 2)  # (B, A, 2) [m/s], after contacts
        self.heading: FloatArray = field(agents, "heading")  # (B, A) [rad] in [-pi, pi)
        self.goal: FloatArray = field(agents, "goal_x", 2)  # (B, A, 2) [m]
        self.status: ByteArray = field(agents, "status")  # (B, A) of Status
        self.present: BoolArray = field(agents, "present")  # (B, A) False: padding, or no body
        self.arrival: FloatArray = field(agents, "arrival")  # (B, A) [s], NaN: not arrived
        self.body_position: FloatArray = field(bodies, "x", 2)  # (B, M, 2) [m]
        self.body_velocity: FloatArray = field(bodies, "vx", 2)  # (B, M, 2) [m/s]
        self.steps_done: IntArray = field(records, "steps_done")  # (B,)
        self.running: BoolArray = field(records, "running")  # (B,)
        self.revision: IntArray = field(records, "revision")  # (B,) count of relocations

    @property
    def B(self) -> int:
        """The number of worlds."""
        return len(self.worlds)

    @property
    def A(self) -> int:
        """The number of agents of the largest world."""
        return int(self.agents.shape[1])

    @property
    def M(self) -> int:
        """The number of bodies of the largest world."""
        return int(self.bodies.shape[1])

    def world(self, b: int) -> World:
        """Return the drawn world from which row b started."""
        return self.worlds[b]

    def step(self, command: FloatArray, twist: BoolArray) -> FloatArray:
        """Advance all running worlds by one decision.

        Args:
            command: (B, A, 2) finite planar velocities [m/s] or twists [m/s, rad/s].
            twist: (B, A) whether each agent's command is a twist, the same in every step.

        Returns:
            (B, A, 2) the commands as executed, within the limits.
        """
        executed = np.zeros((self.B, self.A, 2))
        self._drain(32)
        run_rows(
            step_worlds, self.B, np.ascontiguousarray(command, np.float64),
            np.ascontiguousarray(twist), executed, self.records, self.agents, self.limits,
            self.bodies, self.shapes, self.knots, self.capsules, self.start, self.item,
            self._opened, self._closed, self.hashed, self.spots, self.listed, self.beyond,
        )  # fmt: skip
        return executed

    def fail(self, b: int, agents: IntArray) -> None:
        """End the attempts of ``agents`` in world b, whose navigator failed: they stand still."""
        active = agents[self.status[b, agents] == int(Status.ACTIVE)]
        self.status[b, active] = int(Status.FAILED)
        self.velocity[b, active] = 0.0
        left = (self.status[b] == int(Status.ACTIVE)) & self.present[b]
        self.running[b] = bool(self.running[b] and (left & self.agents["evaluated"][b]).any())

    def contacts(self, b: int) -> Contacts:
        """Return the collision events of world b so far; open ones end now."""
        rows = self._events(b)
        if not len(rows):
            return _NO_CONTACTS
        kind, partner = partners(self.worlds[b], rows["code"])
        return Contacts(
            rows["agent"].copy(), kind, partner, rows["start"].copy(), rows["end"].copy(),
            rows["penetration"].copy(), rows["closing"].copy(), rows["charged"].copy(),
        )  # fmt: skip

    def touched(self, b: int) -> FloatArray:
        """Return the agents' positions (N, 2) [m] at the first touch of each of `contacts`."""
        return field(self._events(b), "x", 2).copy()

    def _events(self, b: int) -> AnyArray:
        """Return CONTACT records of world b, sorted like `Contacts`."""
        self._drain(0)
        agent, slot = np.nonzero(self._opened["code"][b] >= 0)
        if not (len(agent) or self._kept[b]):
            return np.zeros(0, CONTACT)
        going_on = self._opened[b, agent, slot]
        going_on["agent"] = agent
        going_on["end"] = self.records["steps_done"][b] * self.records["dt"][b]
        rows = np.concatenate([*self._kept[b], going_on])
        ordered: AnyArray = rows[np.lexsort((rows["code"], rows["start"], rows["agent"]))]
        return ordered

    def _drain(self, above: int) -> None:
        """Empty the kernels' event lists that hold more than ``above`` events."""
        for b in np.flatnonzero(self.records["closed"] > above):
            self._kept[b].append(self._closed[b, : self.records["closed"][b]].copy())
            self.records["closed"][b] = 0


_NO_CONTACTS = Contacts(
    np.zeros(0, np.int64), np.zeros(0, np.int8), np.zeros(0, np.int64), np.zeros(0),
    np.zeros(0), np.zeros(0), np.zeros(0), np.zeros(0, np.bool_),
)  # fmt: skip


def partners(world: World, codes: IntArray) -> tuple[ByteArray, IntArray]:
    """Return (kind, partner) of recorded codes, as in `Contacts`."""
    which, k = codes % 4, codes // 4
    kind = np.full(len(codes), int(Kind.AGENT), np.int8)
    for row in np.flatnonzero(which != AGENT):
        body = which[row] == BODY
        solid = world.bodies[k[row]].solid if body else world.solids[k[row]]
        kind[row] = int(solid.kind)
    return kind, np.where(which == BODY, -1 - k, k)


def _sees(worlds: Sequence[World]) -> BoolArray:
    """Return which team senses which, (B, teams, teams)."""
    most = max(len(world.teams) for world in worlds)
    sees = np.ones((len(worlds), most, most), np.bool_)
    for b, world in enumerate(worlds):
        sees[b, : len(world.teams), : len(world.teams)] = world.sees
    return sees


def _agent_records(worlds: Sequence[World]) -> AnyArray:
    """Return AGENT records (B, A) of worlds that have not started."""
    most = max(len(world.agents) for world in worlds)
    records = np.zeros((len(worlds), most), AGENT_RECORD)
    records["arrival"], records["tau"] = np.nan, np.inf
    plain = ("heading", "radius", "max_speed", "max_turn_rate", "preferred_speed", "team")
    for row, world in zip(records, worlds, strict=True):
        agents, n = world.agents, len(world.agents)
        row = row[:n]
        row["x"], row["y"] = agents.start[:, 0], agents.start[:, 1]
        row["goal_x"], row["goal_y"] = agents.goal[:, 0], agents.goal[:, 1]
        for name in plain:
            row[name] = getattr(agents, name)
        row["nonholonomic"] = agents.dynamics != int(Dynamics.HOLONOMIC)
        row["enters"], row["queued"] = agents.enters, queue(agents.enters)
        row["evaluated"], row["present"] = agents.evaluated, agents.enters <= SOON
        row["status"] = np.where(row["present"], int(Status.ACTIVE), int(Status.WAITING))
        _write_footprints(agents, row)
    return records


def _write_footprints(agents: Agents, row: AnyArray) -> None:
    """Write the shapes of bodies; a capsule as long as wide is a disc."""
    core = agents.rounding > 0.0
    row["core_length"] = np.where(core, agents.half_length - agents.rounding, 0.0)
    row["core_width"] = np.where(core, agents.half_width - agents.rounding, 0.0)
    row["rounding"] = np.where(core, agents.rounding, agents.radius)
    row["inner_radius"] = agents.inner_radius
    row["shaped"] = (row["core_length"] > 0.0) | (row["core_width"] > 0.0)


def _limit_records(worlds: Sequence[World], most: int) -> AnyArray:
    """Return LIMITS records (B, A), which only worlds with limits read."""
    records = np.zeros((len(worlds), most), LIMITS)
    for row, world in zip(records, worlds, strict=True):
        if world.agents.limited:
            row[: len(world.agents)] = limit_records(world.agents)
    return records


def _world_records(
    worlds: Sequence[World], agents: AnyArray, bodies: AnyArray, knots: AnyArray
) -> AnyArray:
    """Return WORLD records (B,); `stack_fixed` adds the grids' frames."""
    records = np.zeros(len(worlds), WORLD)
    for row, world in zip(records, worlds, strict=True):
        clock, rules = world.clock, world.rules
        row["dt"], row["h"] = clock.dt, clock.dt / clock.substeps
        row["substeps"], row["steps"] = clock.substeps, clock.steps
        row["tolerance"], row["contact"] = rules.goal_tolerance, int(rules.contact)
        row["vanish_on_arrival"] = rules.on_arrival == Afterwards.VANISH
        row["vanish_on_end"] = rules.on_end == Afterwards.VANISH
        row["charge_both"] = rules.charge == Charge.BOTH
        row["agents"], row["bodies"] = len(world.agents), len(world.bodies)
        row["running"] = bool(world.agents.evaluated.any())
        row["limited"] = world.agents.limited
    records["shaped"] = agents["shaped"].any(axis=1)
    records["waiting"] = (agents["status"] == int(Status.WAITING)).sum(axis=1)
    speed, widest = agents["max_speed"].max(axis=1), agents["radius"].max(axis=1)
    top_speeds(bodies, records["bodies"], knots, speed)
    records["widest"] = widest
    # no pair farther apart than this can touch within a substep
    reach = 2.0 * widest + 2.0 * speed * records["h"]
    records["reach"] = 1.001 * reach + 1e-6
    return records
