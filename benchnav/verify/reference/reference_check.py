"""Replay an episode in the reference simulator, each decision from the stored state."""

import math
from time import process_time

import numpy as np

from benchnav.arena.solid import Kind
from benchnav.arena.world import World
from benchnav.arrays import BoolArray, ByteArray
from benchnav.episode.episode import Episode, Status
from benchnav.verify.finding import Report
from benchnav.verify.reference.reference_contacts import Event
from benchnav.verify.reference.reference_simulator import Twin

TOLERANCE = 1e-7  # [m], [rad], [m/s] after one decision
TIME = 1e-6  # [s] of an event: the uncertainty of a touch at grazing incidence
LATE = "replay in the slow reference simulator, stopped when its time was over"
MAX_TOUCHES = 5000  # after which a replay ends: jammed agents touch all the time
GRAZE = 1e-6  # [m/s] and [m] of events that rounding alone may open


def check_twin(
    world: World, episode: Episode, where: str, report: Report, seconds: float = math.inf
) -> None:
    """Report the first decision, and every event, on which the reference simulator disagrees.

    The replay ends after ``seconds`` [s] of processor time, and at the latest when agents jam.

    A disagreement in a decision where rounding may decide the order of touches is counted, but
    is not a finding; nor are later events of the agents concerned.
    """
    end = process_time() + seconds
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
        if twin.touches > MAX_TOUCHES:
            report.notes["replay in the slow reference simulator, stopped in a jam"] += 1
            break
        if process_time() > end and t + 1 < len(episode.requested):
            report.notes[LATE] += 1
            report.counts["decisions without twin"] += len(episode.requested) - (t + 1)
            break
    _check_arrivals(twin, episode, doubted, where, report)
    _check_events(twin, episode, doubted, where, report)


def _disagree(twin: Twin, episode: Episode, t: int, executed: np.ndarray) -> tuple[BoolArray, str]:
    """Return the agents (A,) on which they disagree after decision t, and the difference."""
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
    for name, own, stored, wrong in checks:
        if wrong.any():
            i = int(np.flatnonzero(wrong)[0])
            return (
                wrong,
                f"{name} of agent {i} is {_shown(stored[i])}, in the reference {_shown(own[i])}",
            )
    bodies = _far(twin.bodies, episode.body_position[t + 1])
    if bodies.any():
        m = int(np.flatnonzero(bodies)[0])
        stored, own = episode.body_position[t + 1, m], twin.bodies[m]
        twin.doubtful = False  # no touch influences it
        all_agents = np.ones(len(twin.status), np.bool_)
        return all_agents, f"body {m} is at {_shown(stored)}, in the reference at {_shown(own)}"
    return np.zeros(len(twin.status), np.bool_), ""


def _far(own: np.ndarray, stored: np.ndarray) -> BoolArray:
    far: BoolArray = ~(abs(own - stored) <= TOLERANCE).all(axis=1)
    return far


def _status(episode: Episode, t: int) -> ByteArray:
    """Return the status (A,) without the navigator's failure."""
    status: ByteArray = episode.status[t].copy()
    if episode.failure and t == len(episode.requested):
        status[status == int(Status.FAILED)] = int(Status.ACTIVE)
    return status


def _follow(twin: Twin, episode: Episode, t: int) -> None:
    """Continue from the stored state, so that rounding does not accumulate."""
    twin.position = episode.position[t].copy()
    twin.heading = episode.heading[t].copy()
    twin.status = _status(episode, t)
    for drive, executed in zip(twin.drives, episode.executed[t - 1], strict=True):
        drive.follow(executed)


def _check_arrivals(
    twin: Twin, episode: Episode, doubted: BoolArray, where: str, report: Report
) -> None:
    reached = episode.arrival <= twin.steps * episode.world.clock.dt
    stored = np.where(reached, episode.arrival, math.nan)
    same = np.isclose(twin.arrival, stored, rtol=0.0, atol=TIME, equal_nan=True)
    for i in np.flatnonzero(~same & ~doubted):
        report.find(
            "twin", where,
            f"arrival of agent {i} is {episode.arrival[i]!r}, in the reference {twin.arrival[i]!r}",
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
    own: dict[Key, list[Row]] = {}
    over = [event for event in twin.ledger.closed if event.end <= until]
    for event in sorted(over, key=lambda event: event.start):
        row = (event.start, event.end, event.penetration, event.closing, event.charged)
        own.setdefault(_key(twin, event), []).append(row)
    stored: dict[Key, list[Row]] = {}
    c = episode.contacts
    for n in range(len(c)):
        key = int(c.agent[n]), int(c.kind[n]), int(c.partner[n])
        if c.end[n] > until:
            continue
        row = (c.start[n], c.end[n], c.penetration[n], c.closing_speed[n], bool(c.charged[n]))
        stored.setdefault(key, []).append(tuple(map(_plain, row)))  # type: ignore[arg-type]
    for key in sorted(own.keys() | stored.keys()):
        agent, kind, partner = key
        if doubted[agent] or (kind == Kind.AGENT and doubted[partner]):
            continue
        report.counts["twin events"] += len(stored.get(key, ()))
        text = _compare(stored.get(key, []), own.get(key, []))
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


def _compare(stored: list[Row], own: list[Row]) -> str:
    """Return the difference between the events of one agent with one partner; ``""``: none."""
    if len(stored) != len(own):
        stored, own = _weighty(stored), _weighty(own)
    if len(stored) != len(own):
        return f"{len(stored)} events, in the reference {len(own)}"
    names = ("start", "end", "penetration", "closing speed")
    for left, right in zip(stored, own, strict=True):
        for name, a, b in zip(names, left, right, strict=False):
            if not abs(a - b) <= TIME * max(1.0, abs(b)):
                return f"{name} is {a!r}, in the reference {b!r}"
        if left[4] != right[4]:
            return f"charged is {left[4]}, in the reference {right[4]}"
    return ""


def _weighty(rows: list[Row]) -> list[Row]:
    return [row for row in rows if row[2] > GRAZE or row[3] > GRAZE]


def _plain(value: object) -> object:
    return value if isinstance(value, bool) else float(value)  # type: ignore[arg-type]


def _shown(value: np.ndarray) -> str:
    return np.array2string(np.asarray(value), precision=9, separator=", ")
