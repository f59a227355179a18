"""Builders of synthetic episodes for tests of metrics, without a simulator.

A `Walk` gives the position of one agent at any time. `record` samples walks into an episode
and computes the arrival times. Collisions are given, not simulated.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from benchnav.arena.agents import Agents, Dynamics, Role
from benchnav.arena.body import Body
from benchnav.arena.sensing import Sensing
from benchnav.arena.solid import Kind, Solid
from benchnav.arena.world import Afterwards, Charge, Clock, ContactRule, Rules, World
from benchnav.arrays import Extent, FloatArray
from benchnav.episode.episode import Contacts, Episode, Identity, Status, Timings

Path = Callable[[FloatArray], FloatArray]  # times (N,) [s] -> places (N, 2) [m]
RULES = Rules(0.2, ContactRule.SLIDE, Afterwards.VANISH, Afterwards.VANISH, Charge.HITTER)


@dataclass(frozen=True)
class Hit:
    """A collision event of an agent, charged or not."""

    start: float  # [s]
    duration: float = 0.1  # [s]
    kind: Kind = Kind.WALL
    partner: int = 0
    charged: bool = True


@dataclass(frozen=True)
class Walk:
    """One agent: its position at any time, its goal, and the events of its attempt."""

    path: Path
    goal: tuple[float, float]
    radius: float = 0.3  # [m]
    preferred_speed: float = 1.0  # [m/s]
    role: Role = Role.LEADER
    team: int = 0
    driver: int = 0
    hits: tuple[Hit, ...] = ()
    ends: float | None = None  # [s] from which it is ENDED, at a decision time
    fails: float | None = None  # [s] from which it is FAILED, at a decision time
    enters: float = 0.0  # [s] from which it is in the arena, at a decision time


@dataclass(frozen=True)
class Setting:
    """Settings that all agents share."""

    dt: float = 0.1  # [s]
    horizon: float = 20.0  # [s]
    bounds: Extent = (-20.0, -20.0, 20.0, 20.0)
    solids: tuple[Solid, ...] = ()
    bodies: tuple[Body, ...] = ()
    body_paths: tuple[Path, ...] = ()
    area: Extent | None = None
    rules: Rules = field(default=RULES)
    budget: float | None = None  # [s]
    failure: str = ""


def straight(start: tuple[float, float], velocity: tuple[float, float]) -> Path:
    """Return a path of constant velocity [m/s]; the agent stands still at zero."""
    return lambda t: np.array(start) + t[:, None] * np.array(velocity)


def circle(centre: tuple[float, float], radius: float, speed: float, phase: float = 0.0) -> Path:
    """Return a counter-clockwise circle at constant speed [m/s]."""

    def path(t: FloatArray) -> FloatArray:
        angle = phase + speed / radius * t
        places: FloatArray = np.array(centre) + radius * np.stack([np.cos(angle), np.sin(angle)], 1)
        return places

    return path


def wave(start: tuple[float, float], speed: float, height: float, length: float) -> Path:
    """Return an S-curve along +x: y = height · sin(2π x / length), x at constant speed [m/s]."""

    def path(t: FloatArray) -> FloatArray:
        x = speed * t
        sway = height * np.sin(2.0 * np.pi * x / length)
        return np.array(start) + np.stack([x, sway], axis=1)

    return path


def minimum_jerk(start: tuple[float, float], goal: tuple[float, float], duration: float) -> Path:
    """Return a line from rest to rest: 10 s³ − 15 s⁴ + 6 s⁵ (Flash & Hogan 1985)."""

    def path(t: FloatArray) -> FloatArray:
        s = np.clip(t / duration, 0.0, 1.0)[:, None]
        share = s**3 * (10.0 + s * (6.0 * s - 15.0))
        places: FloatArray = np.array(start) + share * (np.array(goal) - np.array(start))
        return places

    return path


def stop_and_go(start: tuple[float, float], speed: float, period: float) -> Path:
    """Return a path along +x of speed · (1 − cos(2π t / period)): one full stop per period."""

    def path(t: FloatArray) -> FloatArray:
        w = 2.0 * np.pi / period
        x = speed * (t - np.sin(w * t) / w)
        return np.array(start) + np.stack([x, np.zeros_like(x)], axis=1)

    return path


def room(bounds: Extent) -> Solid:
    """Return the inside of four walls: a clockwise loop."""
    x0, y0, x1, y1 = bounds
    return Solid(Kind.WALL, (np.array([[x0, y0], [x0, y1], [x1, y1], [x1, y0]], float),))


def box(
    centre: tuple[float, float], width: float, height: float, kind: Kind = Kind.STATIC
) -> Solid:
    """Return a filled rectangle: a counter-clockwise loop."""
    (x, y), w, h = centre, 0.5 * width, 0.5 * height
    loop = np.array([[x - w, y - h], [x + w, y - h], [x + w, y + h], [x - w, y + h]])
    return Solid(kind, (loop,))


def record(walks: Sequence[Walk], setting: Setting | None = None) -> Episode:
    """Return the episode in which these agents follow their walks, until no agent is active."""
    s = setting if setting is not None else Setting()
    world = _world(walks, s)
    arrival = np.array([_arrival(w, s) for w in walks])
    arrival[arrival > s.horizon] = np.nan
    stop = np.array([_stop(w, at) for w, at in zip(walks, arrival, strict=True)])
    mine = world.agents.evaluated
    last = float(stop[mine].max()) if np.isfinite(stop[mine]).all() else s.horizon
    steps = min(world.clock.steps, max(1, int(np.ceil(last / s.dt - 1e-9))))
    times: FloatArray = np.arange(steps + 1, dtype=np.float64) * s.dt
    position = np.stack(
        [w.path(np.clip(times, w.enters, at)) for w, at in zip(walks, stop, strict=True)], axis=1
    )
    status = np.stack([_status(w, at, times) for w, at in zip(walks, arrival, strict=True)], axis=1)
    arrival[status[-1] != int(Status.ARRIVED)] = np.nan
    velocity = np.diff(position, axis=0) / s.dt
    bodies = [path(times) for path in s.body_paths]
    body_position = np.stack(bodies, axis=1) if bodies else np.zeros((steps + 1, 0, 2))
    return Episode(
        identity=Identity("synthetic/walks@1", "0" * 8, "test", 0, "known", "walks"),
        world=world, position=position, heading=np.zeros((steps + 1, len(walks))), status=status,
        requested=velocity, executed=velocity.copy(), body_position=body_position,
        arrival=arrival, contacts=_contacts(walks),
        timings=Timings(np.full(steps, 1e-3), 0.01, 1), failure=s.failure,
    )  # fmt: skip


def resampled(walks: Sequence[Walk], setting: Setting, factor: int) -> Episode:
    """Return the episode of the same motion with ``factor`` times as many decisions."""
    return record(walks, replace(setting, dt=setting.dt / factor))


def _world(walks: Sequence[Walk], s: Setting) -> World:
    start = np.vstack([w.path(np.array([w.enters])) for w in walks])
    ones = np.ones(len(walks))
    speed = np.array([w.preferred_speed for w in walks])
    agents = Agents(
        start=start, heading=0.0 * ones, goal=np.array([w.goal for w in walks], float),
        radius=np.array([w.radius for w in walks]), max_speed=2.0 * speed, preferred_speed=speed,
        max_turn_rate=ones, dynamics=np.full(len(walks), int(Dynamics.HOLONOMIC), np.int8),
        role=np.array([w.role for w in walks], np.int8), team=np.array([w.team for w in walks]),
        driver=np.array([w.driver for w in walks]), enters=np.array([w.enters for w in walks]),
    )  # fmt: skip
    teams = 1 + max(w.team for w in walks)
    return World(
        bounds=s.bounds, solids=s.solids, bodies=s.bodies, agents=agents,
        teams=tuple(f"team {k}" for k in range(teams)), sees=np.ones((teams, teams), np.bool_),
        clock=Clock(s.dt, 1, round(s.horizon / s.dt), s.budget), rules=s.rules,
        sensing=Sensing(None, None, None), measurement_area=s.area,
    )  # fmt: skip


def _arrival(walk: Walk, s: Setting) -> float:
    """Return when [s] the walk first is within goal tolerance, to a microsecond; NaN if never."""
    times = np.linspace(0.0, s.horizon, 20001)
    away = np.hypot(*(walk.path(times) - np.array(walk.goal)).T)
    inside = np.flatnonzero((away <= s.rules.goal_tolerance) & (times >= walk.enters))
    if len(inside) == 0:
        return float("nan")
    high, low = times[inside[0]], times[max(0, inside[0] - 1)]
    while high - low > 1e-9:
        middle = 0.5 * (low + high)
        off = walk.path(np.array([middle]))[0] - np.array(walk.goal)
        low, high = (low, middle) if np.hypot(*off) <= s.rules.goal_tolerance else (middle, high)
    return float(high)


def _stop(walk: Walk, arrival: float) -> float:
    """Return when [s] the walk ends; inf if never."""
    stops = [t for t in (walk.ends, walk.fails, arrival) if t is not None and t == t]
    return min(stops, default=float("inf"))


def _status(walk: Walk, arrival: float, times: FloatArray) -> np.ndarray:
    status = np.full(len(times), int(Status.ACTIVE), np.int8)
    over = [(arrival, Status.ARRIVED), (walk.ends, Status.ENDED), (walk.fails, Status.FAILED)]
    known = [(t, kind) for t, kind in over if t is not None and t == t]
    if known:
        when, kind = min(known)
        status[times >= when - 1e-9] = int(kind)
    status[times < walk.enters - 1e-9] = int(Status.WAITING)
    return status


def _contacts(walks: Sequence[Walk]) -> Contacts:
    rows = [(a, h) for a, w in enumerate(walks) for h in sorted(w.hits, key=lambda h: h.start)]
    hits = [h for _, h in rows]
    return Contacts(
        agent=np.array([a for a, _ in rows], np.int64),
        kind=np.array([h.kind for h in hits], np.int8),
        partner=np.array([h.partner for h in hits], np.int64),
        start=np.array([h.start for h in hits], np.float64),
        end=np.array([h.start + h.duration for h in hits], np.float64),
        penetration=np.zeros(len(hits)), closing_speed=np.ones(len(hits)),
        charged=np.array([h.charged for h in hits], np.bool_),
    )  # fmt: skip
