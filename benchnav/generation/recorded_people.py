"""The people of a recording in one world, and the person that the robot replaces."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from benchnav.arena.body import Body
from benchnav.arena.solid import Kind
from benchnav.arrays import FloatArray
from benchnav.errors import ScenarioError
from benchnav.generation.motion_law import track_law
from benchnav.generation.placement import NoPlaceError
from benchnav.generation.solids import draw_solid
from benchnav.generation.teams import Crowd
from benchnav.scenario.files.track_file import Track, tracks_of
from benchnav.scenario.files.track_rows import read_rows
from benchnav.scenario.recording import Recording
from benchnav.scenario.scenario import MAX_OBSTACLES, PEOPLE, Scenario
from benchnav.scenario.shape import Disc
from benchnav.scenario.team import PointsGoal, PointsStart, RecordedStart, Team

_SLOWEST = 0.1  # [m/s] desired speed of a person who hardly moves
_TOP = 1.3  # largest over desired speed
_FASTEST = 10.0  # [m/s] of a team, above that of any member


@dataclass(frozen=True, eq=False)
class People:
    """The recording from the moment at which an episode begins."""

    tracks: tuple[Track, ...]  # of those who are present within the horizon; places in metres
    begin: float  # [s] in the recording at t = 0
    replaced: Track | None  # of the person that the robot replaces
    reacting: tuple[Track, ...]  # those of `tracks` who are agents: all or none

    def enters(self, track: Track) -> float:
        """Return when [s] a person appears; 0 for those that are present at the begin."""
        return max(float(track.time[0]) - self.begin, 0.0)


def read_people(scenario: Scenario) -> tuple[Track, ...]:
    """Return the tracks of the scenario's recording in the arena's frame; none without one.

    Raises ScenarioError if the file is wrong, or has no person that the robot can replace.
    """
    recording = scenario.recording
    if recording is None:
        return ()
    path = scenario.folder / recording.file
    rows = read_rows(path, recording.format, recording.columns)
    found = tracks_of(rows, recording.frame_time, recording.gaps)
    offset = np.array(recording.offset)
    tracks = tuple(
        Track(track.number, track.time, track.place * recording.scale + offset) for track in found
    )
    if recording.replace != "none" and not candidates(recording, tracks):
        some = ", ".join(str(n) for n in sorted({track.number for track in tracks})[:10])
        wanted = (
            f"a person whose start and goal are {recording.min_distance:g} m apart"
            if recording.replace == "random"
            else f"id {recording.replace}, which the robot replaces; it has {some}"
        )
        raise ScenarioError(f"{path}:1: the file must hold {wanted}.")
    return tracks


def candidates(recording: Recording, tracks: Sequence[Track]) -> list[int]:
    """Return the indices of the tracks that the robot may replace, ascending."""
    if isinstance(recording.replace, int):
        return [k for k, t in enumerate(tracks) if t.number == recording.replace][:1]
    return [
        k
        for k, track in enumerate(tracks)
        if math.hypot(*(track.place[-1] - track.place[0])) >= recording.min_distance
    ]


def draw_people(
    scenario: Scenario, tracks: Sequence[Track], rng: np.random.Generator
) -> People | None:
    """Return the people of one world; ``rng`` may draw one to replace. None without a recording.

    Raises ScenarioError if more people are present within the horizon than a world may have.
    """
    recording = scenario.recording
    if recording is None:
        return None
    begin, replaced = recording.begin, None
    if recording.replace != "none":
        among = candidates(recording, tracks)
        replaced = tracks[among[int(rng.integers(len(among)))]]
        begin = float(replaced.time[0])
    end = begin + scenario.clock.horizon
    others = tuple(
        track
        for track in tracks
        if track is not replaced and track.time[-1] >= begin and track.time[0] <= end
    )
    if len(others) > MAX_OBSTACLES:
        raise ScenarioError(
            f"{scenario.folder / recording.file}:1: at most {MAX_OBSTACLES} people may be present"
            f" within the horizon of {scenario.clock.horizon:g} s; there are {len(others)}."
        )
    return People(others, begin, replaced, others if recording.driver is not None else ())


def people_bodies(scenario: Scenario, people: People) -> list[Body]:
    """Return the people who follow the recording: discs that appear and vanish with it."""
    recording: Recording = scenario.recording  # type: ignore[assignment] # people come from one
    disc = Disc(type="disc", radius=recording.radius)
    solid = draw_solid(disc, 0.0, Kind.DYNAMIC, np.random.default_rng(0))  # nothing is drawn
    laws = [
        track_law(track.time, track.place, present=True, phase=people.begin)
        for track in people.tracks
        if track not in people.reacting
    ]
    return [Body(solid, law, person=True) for law in laws]


def with_people(scenario: Scenario, people: People | None) -> Scenario:
    """Return the scenario of one world: the robot has its start, and a last team reacts."""
    if people is None:
        return scenario
    teams = [_placed(team, people.replaced) for team in scenario.teams]
    recording = scenario.recording
    if people.reacting and recording is not None and recording.driver is not None:
        points = tuple(_point(start_of(track, people.begin)) for track in people.reacting)
        goals = tuple(_point(track.place[-1]) for track in people.reacting)
        teams.append(
            Team(
                name=PEOPLE, count=float(len(points)), radius=recording.radius,
                max_speed=_FASTEST, driver=recording.driver,
                start=PointsStart(type="points", points=points),
                goal=PointsGoal(type="points", points=goals),
            )
        )  # fmt: skip
    return scenario.model_copy(update={"teams": tuple(teams)})


def add_reacting(people: People, team: Team, crowd: Crowd) -> dict[str, FloatArray]:
    """Add the people who react to the crowd, and return the columns (N,) of their numbers.

    Their desired speed is the mean of their track, and their largest is 1.3 times as high
    (Helbing and Molnár 1995).

    Raises NoPlaceError if one of them touches an agent at t = 0.
    """
    radius: float = team.radius  # type: ignore[assignment] # it is a plain number
    given, _, others = crowd.entering(0.0)
    for track in people.reacting:
        start, enters = start_of(track, people.begin), people.enters(track)
        apart = np.sqrt(np.sum((given - start) ** 2, axis=1))
        if enters == 0.0 and (apart <= others + radius).any():
            raise NoPlaceError(f"id {track.number} of the recording touches an agent at the start")
        crowd.add(start, track.place[-1], radius, enters)
    speed = np.array([max(mean_speed(track), _SLOWEST) for track in people.reacting])
    return {
        "radius": np.full(len(speed), radius), "max_speed": _TOP * speed,
        "preferred_speed": speed, "max_turn_rate": np.full(len(speed), 2.5),
        "heading": np.zeros(len(speed)), "enters": crowd.enters[len(crowd.enters) - len(speed) :],
    }  # fmt: skip


def start_of(track: Track, begin: float) -> FloatArray:
    """Return the place (2,) [m] of a person at ``begin`` [s], or where it appears later."""
    return np.array([np.interp(begin, track.time, track.place[:, k]) for k in (0, 1)])


def mean_speed(track: Track) -> float:
    """Return the length of a track over its duration [m/s]; 0 for a single point."""
    duration = float(track.time[-1] - track.time[0])
    steps: FloatArray = np.diff(track.place, axis=0)
    length = float(np.sqrt(np.sum(steps * steps, axis=1)).sum())
    return length / duration if duration > 0.0 else 0.0


def _placed(team: Team, replaced: Track | None) -> Team:
    """Return the team with the start and goal of the person that it replaces, if it does."""
    if replaced is None or not isinstance(team.start, RecordedStart):
        return team
    place, gap = _point(replaced.place[0]), team.start.separation
    start = PointsStart(type="points", points=(place,), separation=gap)
    goal = PointsGoal(type="points", points=(_point(replaced.place[-1]),))
    return team.model_copy(update={"start": start, "goal": goal})


def _point(place: FloatArray) -> tuple[float, float]:
    return float(place[0]), float(place[1])
