"""A scenario: a frozen, validated description that generates worlds."""

import hashlib
import json
from collections.abc import Iterator, Sequence
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field, PrivateAttr, model_validator

from benchnav.config.document import PathKey, dotted
from benchnav.config.validation import FieldError
from benchnav.errors import did_you_mean
from benchnav.scenario.base import MAX_NAME, NAME_PATTERN, Bounds, Spec, inside
from benchnav.scenario.canonical import added_field, canonical
from benchnav.scenario.entry import enter_together, first_entry
from benchnav.scenario.law import RecordedTrack
from benchnav.scenario.noise import NoiseSpec
from benchnav.scenario.obstacle import DynamicGroup, StaticGroup
from benchnav.scenario.parameters import Parameters, Value, joined_parameters
from benchnav.scenario.recording import Recording
from benchnav.scenario.sampling.packing import lattice, most_that_fit
from benchnav.scenario.sampling.region import region_problem
from benchnav.scenario.sampling.sampler import support
from benchnav.scenario.shape import Mesh, Occupancy, Shape
from benchnav.scenario.team import (
    NavigatorChoice,
    PackedStart,
    PointsGoal,
    PointsStart,
    RecordedStart,
    RegionGoal,
    RegionStart,
    Team,
)
from benchnav.scenario.terms import Clock, Rules, Sensing, Track
from benchnav.scenario.wall import Layout, Wall, layout_problem
from benchnav.system.plain_file import open_file
from benchnav.text.plural import counted

MAX_AGENTS = 5000
MAX_OBSTACLES = 2000
PEOPLE = "people"  # the team of recorded people who react
_PROSE = {"title", "description", "parameters"}  # parameter values count where they are used


class Scenario(Spec):
    """The content of a scenario file. Units: metres, seconds, radians; x right, y up."""

    name: str = Field(
        pattern=NAME_PATTERN,
        max_length=MAX_NAME,
        description="name of the scenario, FAMILY/NAME",
    )
    version: int = Field(
        1,
        ge=1,
        le=10**6,
        description="number that the author raises when results are no longer comparable",
    )
    title: str = Field("", max_length=200, description="one line, shown in lists")
    description: str = Field("", max_length=5000, description="purpose and difficulty")
    parameters: Parameters = Field(
        {}, max_length=20, description="values that users can set with `NAME:key=value`"
    )
    bounds: Bounds = Field(description="edges of the arena: [xmin, ymin, xmax, ymax] [m]")
    walled: bool = Field(True, description="whether walls close the arena at its bounds")
    layout: Layout | None = Field(None, description="generated walls: a maze, or rooms with doors")
    walls: tuple[Wall, ...] = Field(
        (),
        max_length=MAX_OBSTACLES,
        description="single walls; sampled numbers differ between worlds",
    )
    static: tuple[StaticGroup, ...] = Field(
        (), max_length=100, description="obstacles that stand still, placed anew in each world"
    )
    dynamic: tuple[DynamicGroup, ...] = Field(
        (), max_length=100, description="obstacles that follow a motion law and never yield"
    )
    recording: Recording | None = added_field(
        None, "0.3", description="recorded people; the evaluated robot may replace one of them"
    )
    teams: tuple[Team, ...] = Field(min_length=1, max_length=100, description="groups of agents")
    clock: Clock = Field(Clock(), description="time step, horizon and decision budget")
    rules: Rules = Field(Rules(), description="condition of arrival, and effects of contacts")
    sensing: Sensing = Field(Sensing(), description="sensors of every agent")
    noise: NoiseSpec = added_field(
        NoiseSpec(),
        "0.3.0",
        description="errors of the sensors in the perception track `noisy`; the track `exact` has"
        " none",
    )
    tracks: Annotated[tuple[Track, ...], Field(min_length=1, max_length=4)] | None = Field(
        None,
        description="knowledge tracks of the scenario; default: `known`, `partial` and `unknown`,"
        " and `stale` if any group has `moved` or `relocate_at`",
    )
    measurement_area: Bounds | None = Field(
        None, description="region of the density metrics: [xmin, ymin, xmax, ymax] [m]"
    )

    _folder: Path = PrivateAttr(default_factory=Path)
    _chosen: dict[str, Value] = PrivateAttr(default_factory=dict)
    _where: dict[tuple[PathKey, ...], str] = PrivateAttr(default_factory=dict)

    @property
    def folder(self) -> Path:
        """The base folder of file names in the scenario."""
        return self._folder

    def placed_in(
        self,
        folder: Path,
        chosen: dict[str, Value] | None = None,
        where: dict[tuple[PathKey, ...], str] | None = None,
    ) -> "Scenario":
        """Return the same scenario, with file names relative to ``folder``.

        ``chosen`` are its parameters off their defaults; ``where`` gives the
        ``file:line: key`` of parts for messages.
        """
        copy = self.model_copy()
        copy.__dict__.pop("hash", None)
        copy._folder, copy._chosen, copy._where = folder, dict(chosen or {}), dict(where or {})
        return copy

    def moved_to(self, folder: Path) -> "Scenario":
        """Return the same scenario for copies of its files in another folder."""
        return self.placed_in(folder, self._chosen, self._where)

    def where(self, path: Sequence[PathKey]) -> str:
        """Return ``file:line: teams[0].start`` of a part of a team; without file if there is none.

        A part without a place of its own, such as a default, has the place of its parent.
        """
        for stop in range(len(path), 1, -1):
            if tuple(path[:stop]) in self._where:
                return self._where[tuple(path[:stop])]
        return dotted(path)

    @property
    def identity(self) -> str:
        """The text ``name@version``, with ``:key=value`` for parameters off their defaults."""
        return f"{self.name}@{self.version}{joined_parameters(self._chosen)}"

    @cached_property
    def hash(self) -> str:
        """16 hex digits over everything that affects the worlds, including the bytes of files.

        Titles, descriptions and the list of parameters are left out. `canonical` defines how the
        keys enter.
        """
        digest = hashlib.sha256()
        form = canonical(self, exclude=_PROSE)
        digest.update(json.dumps(form, sort_keys=True, separators=(",", ":")).encode())
        for _, path in self.files():
            with open_file(path) as file:
                digest.update(hashlib.file_digest(file, "sha256").digest())
        return digest.hexdigest()[:16]

    @cached_property
    def drivers(self) -> tuple[NavigatorChoice, ...]:
        """Background navigators by first team; an agent with driver k > 0 has entry k - 1."""
        found: list[NavigatorChoice] = []
        for team in self.teams:
            if not team.evaluated and team.driver not in found:
                found.append(team.driver)
        people = self.recording
        if people is not None and people.driver is not None and people.driver not in found:
            found.append(people.driver)
        return tuple(found)

    @property
    def driver_specs(self) -> tuple[dict[str, Any], ...]:
        """Arguments of `benchnav.navigation.plugin.configure.make` for each of `drivers`."""
        return tuple({"type": d.type, **d.params} for d in self.drivers)

    @property
    def granted_tracks(self) -> tuple[Track, ...]:
        """Knowledge tracks in which the scenario may be run; stale only if obstacles were moved."""
        if self.tracks is not None:
            return self.tracks
        moves = any(group.was_moved or group.relocate_at is not None for group in self.static)
        return (
            ("known", "stale", "partial", "unknown") if moves else ("known", "partial", "unknown")
        )

    def files(self) -> Iterator[tuple[tuple[PathKey, ...], Path]]:
        """Yield the key and path of each file that the scenario names, with images of ROS maps."""
        shapes: list[tuple[tuple[PathKey, ...], Shape]] = [
            *((("walls", i), wall.shape) for i, wall in enumerate(self.walls)),
            *((("static", i), group.shape) for i, group in enumerate(self.static)),
        ]
        for place, shape in shapes:
            if isinstance(shape, Mesh | Occupancy):
                key = (*place, "shape", "file")
                path = self._folder / shape.file
                yield key, path
                is_ros = isinstance(shape, Occupancy) and shape.format == "ros"
                image = _image_of(path) if is_ros else None
                if image is not None:
                    yield key, image
        for i, group in enumerate(self.dynamic):
            if isinstance(group.law, RecordedTrack) and group.law.file is not None:
                yield ("dynamic", i, "law", "file"), self._folder / group.law.file
        if self.recording is not None:
            yield ("recording", "file"), self._folder / self.recording.file

    def named_files(self) -> dict[str, Path]:
        """Its files by their names relative to `folder`, or by absolute path where given so."""
        return {
            (
                path.relative_to(self._folder) if path.is_relative_to(self._folder) else path
            ).as_posix(): path
            for _, path in self.files()
        }

    @model_validator(mode="after")
    def _check(self) -> "Scenario":
        for path, problem in _problems(self):
            raise FieldError(path, problem)
        return self


Problem = tuple[tuple[PathKey, ...], str]


def _image_of(path: Path) -> Path | None:
    """Return the image that a ROS map's YAML file names."""
    from benchnav.config.yaml_reader import read_yaml
    from benchnav.errors import ScenarioError

    try:
        data: Any = read_yaml(path).data
    except ScenarioError:
        return None  # the map's own reader reports the problem
    image = path.parent / str(data.get("image", "")) if isinstance(data, dict) else None
    return image if image is not None and image.is_file() else None


def _problems(scenario: Scenario) -> Iterator[Problem]:
    """Yield problems that concern several parts."""
    yield from _team_problems(scenario)
    yield from _place_problems(scenario)
    if scenario.layout is not None and (text := layout_problem(scenario.layout, scenario.bounds)):
        yield ("layout",), text
    most = sum(support(team.count)[1] for team in scenario.teams)
    if most > MAX_AGENTS:
        yield ("teams",), f"must have at most {MAX_AGENTS} agents in all; got up to {most:g}"
    for key, groups in (("static", scenario.static), ("dynamic", scenario.dynamic)):
        total = sum(len(g.points) or support(g.count or 1.0)[1] for g in groups)
        if total > MAX_OBSTACLES:
            yield (key,), f"must have at most {MAX_OBSTACLES} obstacles; got up to {total:g}"
    pieces = sum(len(wall.places) for wall in scenario.walls)
    if pieces > MAX_OBSTACLES:
        yield ("walls",), f"must have at most {MAX_OBSTACLES} pieces; got {pieces}"
    area = scenario.measurement_area
    if area is not None:
        low, high = area[:2], area[2:]
        if not (inside(scenario.bounds, *low) and inside(scenario.bounds, *high)):
            yield ("measurement_area",), "must lie within the bounds"
    tracks = scenario.tracks
    if tracks is not None and len(set(tracks)) < len(tracks):
        yield ("tracks",), "must not name a track twice"
    delay, steps = scenario.noise.delay, scenario.clock.steps
    if delay >= steps:
        yield (
            ("noise", "delay"),
            f"must be shorter than the horizon, which is {steps} decisions; got {delay}",
        )
    yield from _room_problems(scenario)
    yield from _recording_problems(scenario)


def _recording_problems(scenario: Scenario) -> Iterator[Problem]:
    """Yield a start without a recording, and a recording whose robot has no start."""
    robots = [i for i, t in enumerate(scenario.teams) if isinstance(t.start, RecordedStart)]
    replaces = scenario.recording is not None and scenario.recording.replace != "none"
    if robots and not replaces:
        text = "needs a `recording` in which the robot replaces a person"
        yield ("teams", robots[0], "start"), text
    if replaces and len(robots) != 1:
        text = "must be `none` unless one team has a start of type `recorded`"
        yield ("recording", "replace"), text
    people = scenario.recording
    if people is not None and people.driver is not None:
        for i, team in enumerate(scenario.teams):
            if team.name == PEOPLE:
                yield ("teams", i, "name"), f"must not be {PEOPLE!r}: it is that of reacting people"


def _team_problems(scenario: Scenario) -> Iterator[Problem]:
    names, horizon = [team.name for team in scenario.teams], scenario.clock.horizon
    for i, team in enumerate(scenario.teams):
        if first_entry(team.enters) >= horizon:
            text = f"must be before the horizon of {horizon:g} s; the first agent enters at"
            yield ("teams", i, "enters"), f"{text} {first_entry(team.enters):g} s"
        yield from _namesake_problems(scenario.teams[:i], team, i)
        for j, other in enumerate(team.ignores):
            if other not in names:
                yield (
                    ("teams", i, "ignores", j),
                    f"must be the name of a team; got {other!r}.{did_you_mean(other, names)}",
                )
    if not any(team.evaluated and support(team.count)[0] >= 1 for team in scenario.teams):
        yield ("teams",), "must hold at least one evaluated agent (a team without `driver`)"


def _namesake_problems(before: Sequence[Team], team: Team, i: int) -> Iterator[Problem]:
    for j, other in enumerate(before):
        if other.name == team.name and other.role == team.role:
            yield ("teams", i, "name"), f"must be unique; {team.name!r} is teams[{j}]"
        elif other.name == team.name and set(other.ignores) != set(team.ignores):
            yield (
                ("teams", i, "ignores"),
                f"must be that of teams[{j}]: leaders and followers of {team.name!r} are one team",
            )


def _room_problems(scenario: Scenario) -> Iterator[Problem]:
    """Yield teams that are too large for their starts or goals."""
    for i, team in enumerate(scenario.teams):
        most, radius = int(support(team.count)[1]), team.outer_radius[0]
        margin = radius if scenario.walled else 0.0
        for key, place in (("start", team.start), ("goal", team.goal)):
            gap = 0.0
            if isinstance(place, PackedStart):
                room = len(lattice(place.front, place.spacing, place.region, scenario.bounds, most))
                text = f"the region holds {room} points {place.spacing:g} m apart"
            elif isinstance(place, RegionStart | RegionGoal):
                gap = place.separation if isinstance(place, RegionStart) else 0.0
                room = most_that_fit(place.region, scenario.bounds, 2.0 * radius + gap, margin)
                apart = f" that are {gap:g} m apart" if gap else ""
                text = (
                    f"the region holds at most {room} agents of radius {radius:.3g} m{apart},"
                    " in the densest packing"
                )
                if room > 0 and not enter_together(team.enters):
                    continue
                if room == 0:
                    text = f"no circle of radius {radius:.3g} m fits into the region and the bounds"
            else:
                continue
            if most > room:
                if team.footprint is not None:
                    text += ". Enlarge the region, or shrink the footprint"
                yield (
                    ("teams", i, key),
                    f"must have room for all of {team.name!r}, up to {counted(most, 'agent')};"
                    f" {text}",
                )


def _place_problems(scenario: Scenario) -> Iterator[Problem]:
    bounds = scenario.bounds
    for i, team in enumerate(scenario.teams):
        for key, place in (("start", team.start), ("goal", team.goal)):
            if isinstance(place, RegionStart | RegionGoal | PackedStart):
                text = region_problem(place.region, bounds)
                if text:
                    yield ("teams", i, key, "region"), text
            if isinstance(place, PointsStart | PointsGoal):
                for j, point in enumerate(place.points):
                    if not inside(bounds, *point):
                        yield ("teams", i, key, "points", j), "must lie within the bounds"
    groups: list[tuple[str, int, StaticGroup | DynamicGroup]] = [
        *(("static", i, group) for i, group in enumerate(scenario.static)),
        *(("dynamic", i, group) for i, group in enumerate(scenario.dynamic)),
    ]
    for key, i, group in groups:
        if group.region is not None and (text := region_problem(group.region, bounds)):
            yield (key, i, "region"), text
        single = group.at == next(iter(group.points), None)
        for j, point in enumerate(group.points):
            if not inside(bounds, *point):
                yield (key, i, "at") if single else (key, i, "at", j), "must lie within the bounds"
