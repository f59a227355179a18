"""The content of a replay: one episode as JSON, as `replay.js` reads it."""

from typing import Any

import numpy as np

from benchnav.arena.agents import Agents
from benchnav.arena.outline import outline
from benchnav.arena.solid import Kind, Solid
from benchnav.arena.world import World
from benchnav.arrays import FloatArray, IntArray
from benchnav.drawing.palette import TEAMS, color_number
from benchnav.episode.episode import Contacts, Episode, Status
from benchnav.errors import BenchnavError
from benchnav.metrics.attempt_ends import attempt_ends, partner_text
from benchnav.metrics.quantities.episode_analysis import analyse
from benchnav.navigation.tracks import granted_map
from benchnav.runner.rollouts.rollout import Assignment
from benchnav.scenario.condition import condition
from benchnav.verify.own_map import Origin, OwnMaps, Production, map_changes, own_maps
from benchnav.viewer.replay.clearance import clearance
from benchnav.viewer.replay.packing import packed
from benchnav.viewer.replay.senses import Senses, sensed

SENSED = 4  # agents whose readings a replay holds, unless it is asked for others
MILLIMETRE = 0.001
FAR = 100.0  # [m] a larger clearance is shown as this


def scene(episode: Episode, agents: IntArray, origin: Origin | None = None) -> dict[str, Any]:
    """Return the content of the replay of one episode.

    Args:
        episode: the episode.
        agents: (n,) whose sensor readings, charts and own maps are held.
        origin: how the episode was made; None: own maps and the noise of readings are left out.
    """
    world, identity = episode.world, episode.identity
    return {
        "navigator": identity.navigator, "scenario": identity.scenario,
        "condition": condition(identity.track, identity.perception),
        "perception": identity.perception, "seed": identity.seed, "failure": episode.failure,
        "dt": world.clock.dt,
        "horizon": world.clock.horizon, "bounds": list(world.bounds),
        "solids": [_shape(solid) for solid in world.solids],
        "bodies": [_shape(body.solid) for body in world.bodies],
        "map": _map(world, identity.track),
        "agents": _agents(episode), "colours": TEAMS,
        "position": packed(episode.position, MILLIMETRE),
        "heading": packed(_unwrapped(episode.heading), MILLIMETRE),
        "status": packed(episode.status),
        "body_position": packed(episode.body_position, MILLIMETRE),
        "events": events(episode),
        "charts": _charts(episode, agents),
        "senses": _senses(sensed(episode, agents, _assignment(origin)), len(agents)),
        "own_map": None if origin is None else _own_map(own_maps(origin, episode, agents)),
    }  # fmt: skip


def _assignment(origin: Origin | None) -> Assignment | None:
    """Return the assignment of the episode; None if it is unknown."""
    try:
        made = None if origin is None else origin()
    except BenchnavError:  # a part of the run is missing or damaged
        return None
    return made.assignment if isinstance(made, Production) else None


def interesting(episode: Episode) -> IntArray:
    """Return up to four evaluated agents: the failed ones first, in the order of their failure."""
    evaluated = np.flatnonzero(episode.world.agents.evaluated)
    found = analyse(episode)
    order = np.lexsort((found.trajectories.end[evaluated], found.success[evaluated]))
    chosen: IntArray = evaluated[order][:SENSED]
    return chosen


def events(episode: Episode) -> list[dict[str, Any]]:
    """Return contacts, arrivals, failures and the timeout, sorted by time [s].

    A contact between two agents is one event, although each of them has a record of it.
    """
    contacts, world = episode.contacts, episode.world
    last = len(episode.position) - 1
    mirrored = _mirrored(contacts)
    out: list[dict[str, Any]] = []
    for n in range(len(contacts)):
        agent, partner = int(contacts.agent[n]), int(contacts.partner[n])
        kind = Kind(int(contacts.kind[n]))
        text = partner_text(episode.world, int(kind), partner)
        if mirrored[n]:
            continue
        out.append({
            "kind": "contact",
            "time": _rounded(contacts.start[n]), "end": _rounded(contacts.end[n]),
            "agent": agent, "with": kind.name.lower(), "partner": partner, "text": text,
            "charged": bool(contacts.charged[n]),
        })  # fmt: skip
    for agent in range(len(world.agents)):
        if np.isfinite(episode.arrival[agent]):
            out.append(
                {"kind": "arrival", "time": _rounded(episode.arrival[agent]), "agent": agent}
            )
        failed = np.flatnonzero(episode.status[:, agent] == int(Status.FAILED))
        if len(failed):
            time = _rounded(failed[0] * world.clock.dt)
            out.append({"kind": "failure", "time": time, "agent": agent})
    active = world.agents.evaluated & (episode.status[-1] == int(Status.ACTIVE))
    if active.any() and last >= world.clock.steps:
        late = [int(agent) for agent in np.flatnonzero(active)]
        out.append({"kind": "timeout", "time": _rounded(last * world.clock.dt), "agents": late})
    return sorted(out, key=lambda event: float(event["time"]))


def _mirrored(contacts: Contacts) -> list[bool]:
    """Return for each contact whether the partner, an agent before its own, has a record of it."""
    keys = zip(contacts.agent.tolist(), contacts.partner.tolist(), strict=True)
    starts = dict[tuple[int, int], list[float]]()
    between = (contacts.kind == int(Kind.AGENT)).tolist()
    times = contacts.start.tolist()
    rows = list(zip(keys, between, times, strict=True))
    for key, is_agent, time in rows:
        if is_agent:
            starts.setdefault(key, []).append(time)
    return [
        is_agent and b < a and any(abs(s - time) < 1e-9 for s in starts.get((b, a), ()))
        for (a, b), is_agent, time in rows
    ]


def _agents(episode: Episode) -> dict[str, Any]:
    agents, names = episode.world.agents, episode.world.teams
    found = analyse(episode)
    motion = found.trajectories
    enters = np.zeros(len(motion), np.int64) if motion.enters is None else motion.enters
    return {
        "radius": _numbers(agents.radius),
        "outline": [_outline(agents, a) for a in range(len(agents))],
        "team": agents.team.tolist(), "teams": list(names),
        "goal": _numbers(agents.goal), "evaluated": agents.evaluated.tolist(),
        "success": found.success.tolist(), "end": attempt_ends(episode),
        "last": motion.last.tolist(),
        "enters": enters.tolist(), "leaves": motion.leaves.tolist(),
        "colour": [color_number(episode.world, a) for a in range(len(agents))],
    }  # fmt: skip


def _outline(agents: Agents, a: int) -> list[float] | None:
    """Return x, y of the corners of a body that heads along +x [m]; None: a disc."""
    shape = outline(agents, a)
    return None if shape is None else _numbers(shape.ravel())


def _shape(solid: Solid) -> dict[str, Any]:
    kind = Kind(solid.kind).name.lower()
    if solid.is_disc:
        return {"kind": kind, "disc": [*map(_rounded, solid.center), _rounded(solid.radius)]}
    return {"kind": kind, "loops": [_numbers(loop.ravel()) for loop in solid.loops]}


def _map(world: World, track: str) -> list[dict[str, Any]] | None:
    """Return the solids on the granted map at the start; None: there is no map."""
    granted = granted_map(world, track)
    return None if granted is None else [_shape(solid) for solid in granted.solids]


def _own_map(found: OwnMaps | str | None) -> dict[str, Any] | None:
    """Return own maps as JSON: lines once, and the rows that come and go."""
    if found is None or isinstance(found, str):
        return None if found is None else {"reason": found}
    capsules, changes = map_changes(found)
    return {"agents": found.agents.tolist(), "capsules": _numbers(capsules), "changes": changes}


def _charts(episode: Episode, agents: IntArray) -> dict[str, Any]:
    """Return the speed, turn rate and clearance of agents at all times."""
    dt = episode.world.clock.dt
    place, heading = episode.position[:, agents], _unwrapped(episode.heading)[:, agents]
    speed, turn = np.zeros(heading.shape), np.zeros(heading.shape)
    speed[:-1] = np.linalg.norm(np.diff(place, axis=0), axis=-1) / dt
    turn[:-1] = np.diff(heading, axis=0) / dt
    gaps = [np.minimum(clearance(episode, int(agent)), FAR) for agent in agents]
    gap = np.stack(gaps, axis=1) if gaps else np.zeros(heading.shape)
    return {
        "agents": agents.tolist(), "speed": packed(speed, MILLIMETRE),
        "turn": packed(turn, MILLIMETRE), "clearance": packed(gap, MILLIMETRE),
    }  # fmt: skip


def _senses(found: Senses | None, agents: int) -> dict[str, Any] | None:
    """Return the readings as JSON; None: the episode cannot be simulated again."""
    if found is None or not agents:
        return None
    out: dict[str, Any] = {
        "angle": _numbers(found.angle), "edge_table": _numbers(found.edge_table),
        "noisy": found.noisy,
    }  # fmt: skip
    if found.distance is not None and found.kind is not None:
        out["distance"] = packed(found.distance, 0.01)
        out["hit"] = packed(found.kind)
    for name, rows in (("neighbours", found.neighbours), ("edges", found.edges)):
        if rows is not None:
            out[name] = packed(rows)
    if found.places is not None:
        out["places"] = packed(found.places.reshape(*found.places.shape[:2], -1), 0.01)
    if found.probability is not None:
        out["probability"] = packed(found.probability, 0.01)
    return out


def _unwrapped(heading: FloatArray) -> FloatArray:
    return np.unwrap(heading, axis=0)


def _numbers(array: FloatArray) -> Any:
    return np.asarray(array, np.float64).round(3).tolist()


def _rounded(value: float) -> float:
    return round(float(value), 3)
