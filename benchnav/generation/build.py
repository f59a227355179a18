"""Build worlds from scenarios: (scenario, split, seed) → World, a pure function."""

from collections import Counter
from collections.abc import Mapping, Sequence
from functools import partial
from zlib import crc32

import numpy as np

from benchnav.arena.agent_bodies import NO_LIMITS, PLAIN_BODY
from benchnav.arena.agents import Agents, Dynamics, Role
from benchnav.arena.body import Body
from benchnav.arena.noise import EdgeNoise, NeighbourNoise, Noise, OdometryNoise, RayNoise
from benchnav.arena.sensing import EdgeSensor, NeighbourSensor, RaySensor, Sensing
from benchnav.arena.world import Afterwards, Charge, Clock, ContactRule, Rules, World
from benchnav.arrays import AnyArray, BoolArray
from benchnav.errors import UnsolvableError, UsageError, did_you_mean
from benchnav.generation.clearance import Barrier, barrier, joined
from benchnav.generation.dynamic_obstacles import check_clear, fixed_bodies, is_fixed, placed_bodies
from benchnav.generation.entry import draw_entries
from benchnav.generation.footprints import draw_bodies
from benchnav.generation.motion_law import place_at_start
from benchnav.generation.placement import Fault, NoPlaceError, Part
from benchnav.generation.prepared import Prepared, Structure, prepare
from benchnav.generation.recorded_people import (
    add_reacting,
    draw_people,
    people_bodies,
    with_people,
)
from benchnav.generation.static_obstacles import Piece, draw_pieces
from benchnav.generation.teams import Crowd, draw_numbers, place_team
from benchnav.geometry.rotation import angle_of
from benchnav.scenario.sampling.packing import most_that_fit
from benchnav.scenario.sampling.sampler import sample
from benchnav.scenario.scenario import Scenario
from benchnav.scenario.team import RegionStart, Team
from benchnav.scenario.terms import SPLITS, Rays
from benchnav.text.plural import counted

MAX_ATTEMPTS = 100
# streams of one draw
_LAYOUT, _STATIC, _ELSEWHERE, _DYNAMIC, _TEAM, _BODY, _RECORDING, _ENTRY = range(8)


def build(scenario: Scenario, split: str, seed: int) -> World:
    """Return the world of ``scenario`` for ``seed`` ≥ 0 of ``split`` (train, validation or test).

    Every agent's disc can reach its goal from its start, in every arrangement
    of the static obstacles; draws that fail this are rejected and counted.

    Raises:
        UsageError: an unknown split, or a negative seed.
        UnsolvableError: 100 draws were rejected; the message names what found no place.
        InputError: a file that the scenario names is wrong.
    """
    if split not in SPLITS:
        raise UsageError(
            f"The split must be one of {', '.join(SPLITS)}; got {split!r}."
            f"{did_you_mean(split, SPLITS)}"
        )
    if seed < 0:
        raise UsageError(f"The seed must be ≥ 0; got {seed}.")
    prepared = prepare(scenario)
    reasons: Counter[str] = Counter()
    failed: dict[tuple[int, Part], Fault] = {}
    for attempt in range(MAX_ATTEMPTS):
        try:
            return _Draw(prepared, SPLITS.index(split), seed, attempt).world()
        except NoPlaceError as reason:
            reasons[str(reason)] += 1
            if reason.team is not None:
                failed.setdefault((reason.team, reason.part), reason.fault)
    worst = "; ".join(f"{text} ({counted(n, 'draw')})" for text, n in reasons.most_common(3))
    raise UnsolvableError(
        f"{scenario.identity}, split {split}, seed {seed}: no world could be drawn in"
        f" {MAX_ATTEMPTS} draws: {worst}.{_team_message(scenario, failed)}"
    )


def _team_message(scenario: Scenario, failed: Mapping[tuple[int, Part], Fault]) -> str:
    """Describe the starts and goals of teams that found no place: where, and the cure."""
    lines = []
    for (i, part), fault in sorted(failed.items()):
        team = scenario.teams[i]
        radius = team.outer_radius[0]
        text = f"\n{scenario.where(('teams', i, part))} of {team.name!r}"
        if fault == "unreachable":
            lines.append(
                f"{text} is walled off from the start: no path between them is {2 * radius:g} m"
                " wide, which the agents need. Move it, or open the walls."
            )
        elif fault == "blocked":
            lines.append(
                f"{text} must be {radius:g} m, the agents' radius, away from all walls and"
                " obstacles. Move it."
            )
        elif part == "start" and isinstance(team.start, RegionStart):
            lines.append(f"{text} {_room(scenario, team.start, radius)}")
        else:
            lines.append(
                f"{text} has no free place: walls, obstacles or other agents are in the way."
            )
    return "".join(lines)


def _room(scenario: Scenario, start: RegionStart, radius: float) -> str:
    """Describe how many agents fit at most."""
    margin = radius if scenario.walled else 0.0
    gap = start.separation
    room = most_that_fit(start.region, scenario.bounds, 2.0 * radius + gap, margin)
    return (
        f"holds at most {counted(room, 'agent')} of radius {radius:g} m that are {gap:g} m apart,"
        " densely packed and without other objects; at random places, about half as many"
        " fit."
    )


class _Draw:
    """One attempt. Every part draws from its own random stream, independent of the others."""

    def __init__(self, prepared: Prepared, split: int, seed: int, attempt: int) -> None:
        self.prepared = prepared
        self.seed, self.attempt = seed, attempt
        self.key = (split, crc32(prepared.scenario.name.encode()), attempt)
        rng = self.stream(_RECORDING)
        self.people = draw_people(prepared.scenario, prepared.people, rng)
        self.scenario = with_people(prepared.scenario, self.people)

    def stream(self, part: int, index: int = 0) -> np.random.Generator:
        sequence = np.random.SeedSequence(self.seed, spawn_key=(*self.key, part, index))
        return np.random.Generator(np.random.PCG64(sequence))

    def world(self) -> World:
        scenario = self.scenario
        structure = self.prepared.structure(partial(self.stream, _LAYOUT))
        given = self.given_bodies()
        pieces = self.pieces(structure, given)
        now = _with(structure.wall, [piece.solid for piece in pieces])
        replaced = [piece for piece in pieces if piece.after is not None]
        later = _with(structure.wall, [piece.after_solid for piece in pieces]) if replaced else None
        bodies = self.bodies(given, now if later is None else joined(now, later))
        moved = any(piece.before is not None for piece in pieces)
        staying = [piece for piece in pieces if piece.after is None]
        return World(
            bounds=scenario.bounds,
            solids=(*structure.solids, *(piece.solid for piece in staying)),
            bodies=(*bodies, *(piece.body for piece in replaced)),
            agents=self.agents(structure, now, later, bodies),
            teams=_names(scenario.teams),
            sees=_sees(scenario.teams),
            clock=clock_of(scenario),
            rules=rules_of(scenario),
            sensing=sensing_of(scenario),
            stale_solids=(*structure.solids, *(piece.before_solid for piece in staying))
            if moved
            else None,
            measurement_area=scenario.measurement_area,
            meshes=structure.meshes,
            redraws=self.attempt,
        )

    def given_bodies(self) -> list[list[Body]]:
        """Return the bodies of each group with fixed places; empty for the other groups."""
        return [
            fixed_bodies(group, self.scenario.folder, self.stream(_DYNAMIC, i))
            if is_fixed(group)
            else []
            for i, group in enumerate(self.scenario.dynamic)
        ]

    def pieces(self, structure: Structure, given: list[list[Body]]) -> list[Piece]:
        groups = self.scenario.static
        keep_free = self.prepared.fixed_barrier([body for bodies in given for body in bodies])
        return draw_pieces(
            groups, self.scenario.bounds, structure.wall, keep_free,
            partial(self.stream, _STATIC), partial(self.stream, _ELSEWHERE), self.scenario.folder,
        )  # fmt: skip

    def bodies(self, given: list[list[Body]], standing: Barrier) -> list[Body]:
        drawn: list[Body] = []
        for i, group in enumerate(self.scenario.dynamic):
            if is_fixed(group):
                check_clear(given[i], group, f"dynamic[{i}]", standing)
                drawn += given[i]
            else:
                rng = self.stream(_DYNAMIC, i)
                bounds = self.scenario.bounds
                drawn += placed_bodies(group, f"dynamic[{i}]", bounds, standing, rng)
        if self.people is not None:
            drawn += people_bodies(self.scenario, self.people)
        return drawn

    def agents(
        self, structure: Structure, now: Barrier, later: Barrier | None, bodies: list[Body]
    ) -> Agents:
        scenario = self.scenario
        there = barrier([body.solid.moved(place_at_start(body.law)) for body in bodies])
        crowd = Crowd()
        columns: list[dict[str, AnyArray]] = []
        for i, team in enumerate(scenario.teams):
            if self.people is not None and i == len(self.prepared.scenario.teams):
                columns.append(add_reacting(self.people, team, crowd))
                continue
            rng = self.stream(_BODY, i)
            count = int(sample(team.count, rng))
            enters = draw_entries(team.enters, count, self.stream(_ENTRY, i))
            columns.append({**_numbers(team, count, rng), "enters": enters})
            reach = team.outer_radius[1]
            spaces = [self.prepared.space(structure, now, reach)]
            if later is not None:
                spaces.append(self.prepared.space(structure, later, reach))
            radii = columns[i]["radius"]
            try:
                place_team(
                    team, radii, enters, crowd, scenario.bounds, spaces, there,
                    self.stream(_TEAM, i),
                )  # fmt: skip
            except NoPlaceError as reason:
                reason.team = i
                raise
        return _assemble(scenario, crowd, columns)


def _with(wall: Barrier, solids: Sequence[object]) -> Barrier:
    return joined(wall, barrier(solids)) if solids else wall  # type: ignore[arg-type]


def _numbers(team: Team, count: int, rng: np.random.Generator) -> dict[str, AnyArray]:
    """Draw the numbers of a team's agents, each (count,)."""
    top = draw_numbers(team.max_speed, count, rng)
    preferred = team.preferred_speed
    heading = 0.0 if team.heading == "goal" else team.heading
    return {
        **draw_bodies(team, count, rng),
        "max_speed": top,
        "preferred_speed": top.copy()
        if preferred is None
        else np.minimum(draw_numbers(preferred, count, rng), top),
        "max_turn_rate": draw_numbers(team.max_turn_rate, count, rng),
        "heading": draw_numbers(heading, count, rng),
        **_limits(team, count, rng),
    }


def _limits(team: Team, count: int, rng: np.random.Generator) -> dict[str, AnyArray]:
    """Draw the columns (count,) of `AgentBodies` that the team gives."""
    drawn: dict[str, AnyArray] = {}
    for name in NO_LIMITS:
        limit = getattr(team, name, getattr(team.dynamics, name, None))
        if isinstance(limit, bool):
            drawn[name] = np.full(count, limit)
        elif limit is not None:
            drawn[name] = draw_numbers(limit, count, rng)
        elif name == "max_deceleration" and "max_acceleration" in drawn:
            drawn[name] = drawn["max_acceleration"].copy()
    return drawn


def _assemble(scenario: Scenario, crowd: Crowd, columns: list[dict[str, AnyArray]]) -> Agents:
    sizes = [len(column["radius"]) for column in columns]
    entry = np.repeat(np.arange(len(sizes)), sizes)
    names = _names(scenario.teams)
    team = np.array([names.index(t.name) for t in scenario.teams], np.int64)[entry]

    def column(name: str) -> AnyArray:
        parts = [part.get(name) for part in columns]
        missing = PLAIN_BODY.get(name)
        return np.concatenate(
            [
                np.full(size, missing) if part is None else part
                for part, size in zip(parts, sizes, strict=True)
            ]
        )

    heading = column("heading")
    for a in range(len(entry)):
        if scenario.teams[entry[a]].heading == "goal":
            way = crowd.goal[a] - crowd.start[a]
            heading[a] = angle_of(way[0], way[1])
    dynamics = [Dynamics[t.dynamics.type.upper().replace("-", "_")] for t in scenario.teams]
    roles = [Role[t.role.upper()] for t in scenario.teams]
    drivers = [0 if t.evaluated else 1 + scenario.drivers.index(t.driver) for t in scenario.teams]
    return Agents(
        start=crowd.start, heading=heading, goal=crowd.goal, radius=column("radius"),
        max_speed=column("max_speed"), preferred_speed=column("preferred_speed"),
        max_turn_rate=column("max_turn_rate"),
        dynamics=np.repeat(np.array(dynamics, np.int8), sizes),
        role=np.repeat(np.array(roles, np.int8), sizes),
        team=team, driver=np.repeat(np.array(drivers, np.int64), sizes),
        **{name: column(name) for name in PLAIN_BODY},
    )  # fmt: skip


def _names(teams: Sequence[Team]) -> tuple[str, ...]:
    """Return the team names without duplicates: leaders and followers of one name are one team."""
    return tuple(dict.fromkeys(team.name for team in teams))


def _sees(teams: Sequence[Team]) -> BoolArray:
    blind = {team.name: set(team.ignores) for team in teams}
    names = _names(teams)
    return np.array([[other not in blind[name] for other in names] for name in names])


def clock_of(scenario: Scenario) -> Clock:
    """Return the clock of every world of ``scenario``."""
    clock = scenario.clock
    return Clock(clock.dt, clock.substeps, clock.steps, clock.decision_budget)


def rules_of(scenario: Scenario) -> Rules:
    """Return the rules of every world of ``scenario``."""
    rules = scenario.rules
    return Rules(
        rules.goal_tolerance,
        ContactRule[rules.contact.upper()],
        Afterwards[rules.on_arrival.upper()],
        Afterwards[rules.on_end.upper()],
        Charge[rules.charge.upper()],
    )


def sensing_of(scenario: Scenario) -> Sensing:
    """Return the sensors in every world of ``scenario``."""
    s = scenario.sensing
    return Sensing(
        None if s.rays is None else _ray_sensor(s.rays),
        None if s.neighbours is None else NeighbourSensor(**s.neighbours.model_dump()),
        None if s.edges is None else EdgeSensor(**s.edges.model_dump()),
        s.occlusion,
    )


def _ray_sensor(rays: Rays) -> RaySensor:
    around = rays.thickness == "circumscribed"
    return RaySensor(rays.count, rays.fan, rays.range, rays.thick, around)


def noise_of(scenario: Scenario) -> Noise:
    """Return the noise of the senses in the perception track `noisy` of ``scenario``."""
    n = scenario.noise
    return Noise(
        RayNoise(**n.rays.numbers), NeighbourNoise(**n.neighbours.numbers),
        EdgeNoise(**n.edges.numbers), OdometryNoise(**n.odometry.numbers), n.delay,
    )  # fmt: skip
