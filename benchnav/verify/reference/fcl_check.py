"""Judge every contact of an episode a second time, with trimesh and python-fcl.

There are three checks. At the start of an event, the two partners touch. At every state until
its end, they are close, and overlap no deeper than recorded. And without an event, no
agent overlaps anything, at a state or on the path between two states.

Agents that are not discs are judged at states only, because headings between them are not stored.
"""

import math
from collections.abc import Iterator
from importlib.util import find_spec

import numpy as np

from benchnav.arena.agents import Dynamics
from benchnav.arena.body import absent
from benchnav.arena.solid import Kind
from benchnav.arena.world import Afterwards
from benchnav.arrays import BoolArray, FloatArray
from benchnav.episode.episode import Episode, Status
from benchnav.errors import MissingExtraError
from benchnav.verify.finding import Report
from benchnav.verify.part_check import Pair
from benchnav.verify.reference.reference_contacts import RELEASE, Partner
from benchnav.verify.reference.reference_geometry import inside, law_position

TOUCH = 1e-6  # [m] tolerance of a touch, and of a depth beyond the recorded one
OVERLAP = 1e-3  # [m] an overlap deeper than this must be an event
STRIDE = 0.02  # [m] between checked positions on the path from one state to the next
_NAMES = {Kind.AGENT: "agents", Kind.DYNAMIC: "bodies", Kind.WALL: "solids", Kind.STATIC: "solids"}


def require_referee() -> None:
    """Raise MissingExtraError if the libraries are not installed."""
    if find_spec("fcl") is None or find_spec("trimesh") is None:
        raise MissingExtraError("The referee fcl", "plan")


def judge(pair: Pair, report: Report) -> None:
    """Report every contact of an episode on which the referee disagrees."""
    judgement = _Judgement(pair)
    report.counts["judged events"] += len(pair.again.contacts)
    report.counts["judged states"] += pair.again.status.size
    for text in (*judgement.touches(), *judgement.lasting(), *judgement.missing()):
        report.find("referee", pair.where, text)


class _Judgement:
    def __init__(self, pair: Pair) -> None:
        from benchnav.verify.reference.fcl_scene import Scene, extent

        self.episode, self.touched = pair.again, pair.touched
        self.world = pair.again.world
        self.dt = self.world.clock.dt
        self.scene = Scene(self.world)
        self.extents = [extent(solid) for solid in self.world.solids]
        self.partners = [self._partner(n) for n in range(len(self.episode.contacts))]

    def _partner(self, n: int) -> Partner:
        kind, k = Kind(int(self.episode.contacts.kind[n])), int(self.episode.contacts.partner[n])
        if k < 0:
            return "bodies", -1 - k
        return _NAMES[kind], k

    def _named(self, n: int) -> str:
        c = self.episode.contacts
        kind = Kind(int(c.kind[n])).name.lower()
        return f"agent {c.agent[n]} with {kind} {c.partner[n]} from {c.start[n]:.6f} s"

    def touches(self) -> Iterator[str]:
        """Yield events that do not start with a touch; only what never yields may start deeper."""
        c = self.episode.contacts
        for n, partner in enumerate(self.partners):
            at, i = self._place_at(n, partner), int(c.agent[n])
            if at is None or self._turns(i, partner):
                continue
            gap = self._gap(i, self.touched[n], 0, partner, at)
            if gap > TOUCH:
                yield f"{self._named(n)}: they are {gap:.9f} m apart then"
            elif gap < -TOUCH and partner[0] != "bodies":
                yield f"{self._named(n)}: they overlap by {-gap:.9f} m then"

    def _turns(self, i: int, partner: Partner) -> bool:
        """Whether the gap of agent i and a partner depends on a heading."""
        name, k = partner
        shaped = self.scene.shapes.shaped
        return bool(shaped[i] or (name == "agents" and shaped[k]))

    def _place_at(self, n: int, partner: Partner) -> FloatArray | None:
        """Return the partner's position at the start of event n; None if its own event is older."""
        c, (name, k) = self.episode.contacts, partner
        if name == "solids":
            return np.zeros(2)
        if name == "bodies":
            return self._body_at(k, float(c.start[n]))
        same = (c.agent == k) & (c.partner == c.agent[n]) & (c.kind == int(Kind.AGENT))
        mirrored = np.flatnonzero(same & (c.start == c.start[n]))
        return self.touched[mirrored[0]] if len(mirrored) else None

    def _body_at(self, m: int, time: float) -> FloatArray:
        """Return a body's position: straight between substeps; relocated ones as in the state."""
        body, h = self.world.bodies[m], self.dt / self.world.clock.substeps
        if body.solid.kind == Kind.STATIC:
            state = min(int(time / self.dt) + 1, len(self.episode.body_position) - 1)
            there: FloatArray = self.episode.body_position[state, m]
            return there
        tick = math.floor(time / h + 1e-9)
        a, b = (law_position(body, (tick + s) * h, False) for s in (0, 1))
        if absent(a) != absent(b):  # it stands until the substep ends
            return a
        return a + (b - a) * min(max(time / h - tick, 0.0), 1.0)

    def lasting(self) -> Iterator[str]:
        """Yield states within an event where the two are apart, or deeper than recorded."""
        c, e = self.episode.contacts, self.episode
        for n, partner in enumerate(self.partners):
            first = math.floor(c.start[n] / self.dt) + 1
            for t in range(first, min(math.ceil(c.end[n] / self.dt - 1e-9), len(e.position))):
                i, at = int(c.agent[n]), self._stored(partner, t)
                gap = self._gap(i, e.position[t, i], t, partner, at)
                if gap > RELEASE + TOUCH:
                    yield f"{self._named(n)}: they are {gap:.6f} m apart at {t * self.dt:.3f} s"
                    break
                if -gap > c.penetration[n] + TOUCH:
                    yield f"{self._named(n)}: they overlap by {-gap:.6f} m at {t * self.dt:.3f} s"
                    break

    def _stored(self, partner: Partner, t: int) -> FloatArray:
        name, k = partner
        if name == "solids":
            return np.zeros(2)
        array = self.episode.position if name == "agents" else self.episode.body_position
        place: FloatArray = array[t, k]
        return place

    def _gap(self, i: int, place: FloatArray, t: int, partner: Partner, at: FloatArray) -> float:
        """Return the gap in the scene, with the headings of state t.

        For the centre of a disc within a body, it is the depth as in the kernels.
        """
        name, k = partner
        gap = self.scene.gap(i, place, self.episode.heading[t], partner, at)
        solid = self.world.bodies[k].solid if name == "bodies" else None
        if (
            solid is None
            or self.scene.shapes.shaped[i]
            or solid.is_disc
            or not inside(place - at, solid.loops)
        ):
            return gap
        radius = float(self.world.agents.radius[i])
        away = gap if gap > 0.0 else radius + gap  # from the rim or the centre to the surface
        return -(away + 2.0 * radius if gap > 0.0 else away + radius)

    def missing(self) -> Iterator[str]:
        """Yield overlaps of active agents that no event covers."""
        reported: set[tuple[int, Partner]] = set()
        for t in range(len(self.episode.position)):
            present = _present(self.episode, t)
            for i in np.flatnonzero(self.episode.status[t] == int(Status.ACTIVE)):
                places = self._way(int(i), t)
                for partner, place, at in self._near(int(i), t, places, present):
                    if (int(i), partner) in reported or self._covered(int(i), partner, t):
                        continue
                    gap = self._gap(int(i), place, t, partner, at)
                    if gap < -OVERLAP:
                        reported.add((int(i), partner))
                        name, k = partner
                        if name == "bodies" and self._appears(k, t):
                            continue  # on the agent, which is no touch
                        yield (
                            f"agent {i} overlaps {name} {k} by {-gap:.6f} m"
                            f" at about {t * self.dt:.3f} s, and there is no event"
                        )

    def _appears(self, m: int, t: int) -> bool:
        """Whether body m was absent in the state before t."""
        return t > 0 and bool(absent(self.episode.body_position[t - 1, m]))

    def _covered(self, i: int, partner: Partner, t: int) -> bool:
        """Whether there is an event of the two in the decisions before or after state t."""
        c = self.episode.contacts
        return any(
            self.partners[n] == partner
            and c.start[n] <= (t + 1) * self.dt + 1e-9
            and c.end[n] >= (t - 1) * self.dt - 1e-9
            for n in np.flatnonzero(c.agent == i)
        )

    def _way(self, i: int, t: int) -> FloatArray:
        """Return positions (N, 2) [m] from state t to the next; only the state after a touch.

        An agent without contact moves by its executed command.
        """
        e, c = self.episode, self.episode.contacts
        here: FloatArray = e.position[t, i][None]
        begin, end = t * self.dt, (t + 1) * self.dt
        disturbed = (c.agent == i) & (c.start <= end) & (c.end >= begin)
        if self.scene.shapes.shaped[i]:
            return here
        if t == len(e.executed) or disturbed.any() or e.status[t + 1, i] != int(Status.ACTIVE):
            return here
        drive, heading = e.executed[t, i], float(e.heading[t, i])
        twist = bool(e.twist[i]) if e.twist is not None else False
        turning = twist or self.world.agents.dynamics[i] != int(Dynamics.HOLONOMIC)
        substeps = self.world.clock.substeps
        h, corner, places = self.dt / substeps, here[0], [here]
        for s in range(substeps):
            angle = heading + (s + 0.5) * drive[1] * h
            velocity = drive
            if turning:
                velocity = drive[0] * np.array([math.cos(angle), math.sin(angle)])
            count = max(1, math.ceil(math.hypot(*velocity) * h / STRIDE))
            share = np.arange(1, count + 1)[:, None] / count
            places.append(corner + share * velocity * h)
            corner = places[-1][-1]
        return np.vstack(places)

    def _near(
        self, i: int, t: int, places: FloatArray, present: BoolArray
    ) -> Iterator[tuple[Partner, FloatArray, FloatArray]]:
        """Yield (partner, position of agent i, position of the partner) of all that may overlap."""
        r = float(self.world.agents.radius[i])
        for k, (low, high) in enumerate(self.extents):
            close = ((places + r > low) & (places - r < high)).all(axis=1)
            for place in places[close]:
                yield ("solids", k), place, np.zeros(2)
        here = places[0]
        for m, body in enumerate(self.world.bodies):
            at = self.episode.body_position[t, m]
            if math.hypot(*(here - at)) < r + body.solid.bounding_radius:
                yield ("bodies", m), here, at
        away = np.hypot(*(self.episode.position[t] - here).T)
        for j in np.flatnonzero(present & (away < r + self.world.agents.radius)):
            if j != i:
                yield ("agents", int(j)), here, self.episode.position[t, j]


def _present(episode: Episode, t: int) -> BoolArray:
    """Return the agents (A,) with a body at state t."""
    status, rules = episode.status[t], episode.world.rules
    gone = status == int(Status.WAITING)
    gone |= (status == int(Status.ARRIVED)) & (rules.on_arrival == Afterwards.VANISH)
    gone |= (status == int(Status.ENDED)) & (rules.on_end == Afterwards.VANISH)
    here: BoolArray = ~gone
    return here
