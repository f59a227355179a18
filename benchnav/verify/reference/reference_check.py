"""Replays an episode through the slow twin, decision by decision from the stored states."""

import math

import numpy as np

from benchnav.arena.solid import Kind
from benchnav.arena.world import World
from benchnav.arrays import BoolArray, ByteArray
from benchnav.episode.episode import Episode, Status
from benchnav.verify.finding import Report
from benchnav.verify.reference.reference_contacts import Event
from benchnav.verify.reference.reference_simulator import Twin

TOLERANCE = 1e-7  # [m], [rad], [m/s] after one decision
TIME = 1e-6  # [s] of an event: a touch at grazing incidence is that uncertain
MOST_TOUCHES = 5000  # after which a replay ends: agents that jam touch all the time
GRAZE = 1e-6  # [m/s] and [m] of events that rounding alone may open


def check_twin(world: World, episode: Episode, where: str, report: Report) -> None:
    """Report the first decision, and every event, that the twin sees otherwise.

    A decision that the twin sees otherwise, and in which rounding may decide who touches
    first, is counted and not held against anybody; nor are events of whom it concerns.
    """
    twin, doubted = Twin(world), np.zeros(len(world.agents), np.bool_)
    twist = np.zeros(len(doubted), np.bool_) if episode.twist is None else episode.twist
    report.counts["twin episodes"] += 1
    for t in range(len(episode.requested)):
        executed = twin.step(episode.requested[t], twist)
        report.counts["twin decisions"] += 1
        wrong, what = _disagree(twin, episode, t, executed)
        if wrong.any() and not twin.doubtful:
            report.find("twin", where, f"decision {t}: {what}")
            return
        if wrong.any():
            doubted |= wrong
            report.notes["decision of a replayed episode that rounding may decide"] += 1
        _follow(twin, episode, t + 1)
        if twin.touches > MOST_TOUCHES:
            report.notes["replay through the slow twin, cut short in a jam"] += 1
            break
    _check_arrivals(twin, episode, doubted, where, report)
    _check_events(twin, episode, doubted, where, report)


def _disagree(twin: Twin, episode: Episode, t: int, executed: np.ndarray) -> tuple[BoolArray, str]:
    """(A,) about whom they disagree after decision t, and how, in words."""
    status = _status(episode, t + 1)
    turned = np.remainder(twin.heading - episode.heading[t + 1] + math.pi, 2.0 * math.pi) - math.pi
    there = twin.present
    checks = (
        ("status", twin.status, status, twin.status != status),
        ("executed", executed, episode.executed[t],
         _far(executed, episode.executed[t])),
        ("position", twin.position, episode.position[t + 1],
         _far(twin.position, episode.position[t + 1])),
        ("heading", twin.heading, episode.heading[t + 1], there & (abs(turned) > TOLERANCE)),
    )  # fmt: skip
    for name, mine, stored, wrong in checks:
        if wrong.any():
            i = int(np.flatnonzero(wrong)[0])
            return (
                wrong,
                f"{name} of agent {i} is {_shown(stored[i])}, by the twin {_shown(mine[i])}",
            )
    bodies = _far(twin.bodies, episode.body_position[t + 1])
    if bodies.any():
        m = int(np.flatnonzero(bodies)[0])
        stored, mine = episode.body_position[t + 1, m], twin.bodies[m]
        twin.doubtful = False  # no touch has a say in it
        everybody = np.ones(len(twin.status), np.bool_)
        return everybody, f"body {m} is at {_shown(stored)}, by the twin at {_shown(mine)}"
    return np.zeros(len(twin.status), np.bool_), ""


def _far(mine: np.ndarray, stored: np.ndarray) -> BoolArray:
    far: BoolArray = ~(abs(mine - stored) <= TOLERANCE).all(axis=1)
    return far


def _status(episode: Episode, t: int) -> ByteArray:
    """(A,) before the navigator's failure was told."""
    status: ByteArray = episode.status[t].copy()
    if episode.failure and t == len(episode.requested):
        status[status == int(Status.FAILED)] = int(Status.ACTIVE)
    return status


def _follow(twin: Twin, episode: Episode, t: int) -> None:
    """Go on from the stored state, so that rounding does not add up."""
    twin.position = episode.position[t].copy()
    twin.heading = episode.heading[t].copy()
    twin.status = _status(episode, t)


def _check_arrivals(
    twin: Twin, episode: Episode, doubted: BoolArray, where: str, report: Report
) -> None:
    reached = episode.arrival <= twin.steps * episode.world.clock.dt
    stored = np.where(reached, episode.arrival, math.nan)
    same = np.isclose(twin.arrival, stored, rtol=0.0, atol=TIME, equal_nan=True)
    for i in np.flatnonzero(~same & ~doubted):
        report.find(
            "twin", where,
            f"arrival of agent {i} is {episode.arrival[i]!r}, by the twin {twin.arrival[i]!r}",
        )  # fmt: skip


Key = tuple[int, int, int]  # agent, kind, partner
Row = tuple[float, float, float, float, bool]  # start, end, penetration, closing, charged


def _check_events(
    twin: Twin, episode: Episode, doubted: BoolArray, where: str, report: Report
) -> None:
    end, until = twin.steps * episode.world.clock.dt, math.inf
    if twin.steps < len(episode.requested):
        until = end - TIME
    else:
        for event in list(twin.ledger.opened.values()):
            twin.ledger.close(event, end)
    mine: dict[Key, list[Row]] = {}
    over = [event for event in twin.ledger.closed if event.end <= until]
    for event in sorted(over, key=lambda event: event.start):
        row = (event.start, event.end, event.penetration, event.closing, event.charged)
        mine.setdefault(_key(twin, event), []).append(row)
    stored: dict[Key, list[Row]] = {}
    c = episode.contacts
    for n in range(len(c)):
        key = int(c.agent[n]), int(c.kind[n]), int(c.partner[n])
        if c.end[n] > until:
            continue
        row = (c.start[n], c.end[n], c.penetration[n], c.closing_speed[n], bool(c.charged[n]))
        stored.setdefault(key, []).append(tuple(map(_plain, row)))  # type: ignore[arg-type]
    for key in sorted(mine.keys() | stored.keys()):
        agent, kind, partner = key
        if doubted[agent] or (kind == Kind.AGENT and doubted[partner]):
            continue
        report.counts["twin events"] += len(stored.get(key, ()))
        text = _compare(stored.get(key, []), mine.get(key, []))
        if text:
            report.find(
                "twin", where, f"agent {agent} with {Kind(kind).name.lower()} {partner}: {text}"
            )


def _key(twin: Twin, event: Event) -> Key:
    name, k = event.partner
    if name == "agent":
        return event.agent, int(Kind.AGENT), k
    if name == "solid":
        return event.agent, int(twin.world.solids[k].kind), k
    return event.agent, int(twin.world.bodies[k].solid.kind), -1 - k


def _compare(stored: list[Row], mine: list[Row]) -> str:
    """What is different between the events of one agent with one partner; ``""``: nothing."""
    if len(stored) != len(mine):
        stored, mine = _weighty(stored), _weighty(mine)
    if len(stored) != len(mine):
        return f"{len(stored)} events, by the twin {len(mine)}"
    names = ("start", "end", "penetration", "closing speed")
    for left, right in zip(stored, mine, strict=True):
        for name, a, b in zip(names, left, right, strict=False):
            if not abs(a - b) <= TIME * max(1.0, abs(b)):
                return f"{name} is {a!r}, by the twin {b!r}"
        if left[4] != right[4]:
            return f"charged is {left[4]}, by the twin {right[4]}"
    return ""


def _weighty(rows: list[Row]) -> list[Row]:
    return [row for row in rows if row[2] > GRAZE or row[3] > GRAZE]


def _plain(value: object) -> object:
    return value if isinstance(value, bool) else float(value)  # type: ignore[arg-type]


def _shown(value: np.ndarray) -> str:
    return np.array2string(np.asarray(value), precision=9, separator=", ")
