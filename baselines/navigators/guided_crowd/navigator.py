"""The guided crowd: each group follows its leader's rehearsed path, and ORCA has priority."""

from collections.abc import Sequence
from typing import Any, ClassVar, Literal

import numpy as np
from pydantic import Field

from benchnav.arrays import FloatArray, IntArray
from benchnav.navigation import Briefing, Navigator, Need, Observation, PluginConfig, RowTable, Spec
from benchnav.threads import run_rows

from ...controllers.orca.avoidance import LEAST, Avoidance, OrcaConfig, no_edges
from .group import Group, groups_of, leaders_in, misfit, places_in_corridor, turn_offs
from .guiding_path import GuidingPath, best_path
from .march import BLOCKED, CUT_OFF, march
from .path_file import fingerprint_of, read_paths


class GuidedCrowdConfig(PluginConfig):
    """Parameters of the guided crowd."""

    rehearsal: int = Field(
        5, ge=1, le=100, description="rehearsals of the leaders before each episode; charged"
    )
    leader: str | dict[str, Any] = Field(
        "recurrent-ppo-vo",
        description="navigator of the leaders in rehearsals: name or {type: name, …}",
    )
    path: str | None = Field(
        None,
        min_length=1,
        description="file of guiding paths, preferred to rehearsed ones if they fit a group",
    )
    fit: float = Field(
        3.0, ge=0, description="[m] largest distance of their ends from the leader's start and goal"
    )
    fallback: Literal["orca", "collided"] = Field(
        "orca",
        description="behaviour of a group whose leader never succeeded: go straight to its goals"
        " with ORCA, or follow the fastest trajectory that arrived with a collision, if any",
    )
    lookahead: float = Field(
        2.0, gt=0, description="[m] distance along the path from a member to its target"
    )
    spread: float = Field(3.0, ge=0, description="[m] half width of the corridor around the path")
    leaving: float = Field(
        3.0,
        ge=0,
        description="[m] a member leaves the path this far before the point of the path that is"
        " nearest to its goal",
    )
    tolerance: float = Field(
        0.05, ge=0, description="[m] tolerance when the trajectory is simplified to a path"
    )
    orca: OrcaConfig = Field(OrcaConfig(), description="parameters of the avoidance")


class GuidedCrowd(Navigator):
    """Members follow their leader's best rehearsed trajectory, spread over a corridor around it.

    If ORCA predicts a collision, it decides; otherwise the path does. The last stretch leads
    straight to each member's own goal. `paths` are the guiding paths of each row, and
    `remarks` report problems with them.
    """

    Config = GuidedCrowdConfig
    needs: ClassVar[frozenset[Need]] = frozenset({Need.NEIGHBOURS, Need.EDGES})

    def __init__(self, config: PluginConfig | None = None) -> None:
        super().__init__(config)
        self.paths: dict[int, dict[int, GuidingPath]] = {}  # row → leader → its path
        self._given = () if self.config.path is None else read_paths(self.config.path)
        self._avoidance = Avoidance(self.config.orca)
        self._table = RowTable()
        self._state: dict[int, _Row] = {}
        self._flat = _Flat({})

    @property
    def uses_map(self) -> bool:
        return False

    @property
    def rehearsal(self) -> int:
        return int(self.config.rehearsal)

    @property
    def leader(self) -> Spec | None:
        spec: Spec = self.config.leader
        return spec

    @property
    def fingerprint(self) -> str:
        return "" if self.config.path is None else fingerprint_of(self.config.path)

    def reset(self, briefings: Sequence[Briefing], rows: IntArray) -> None:
        self._avoidance.reset(briefings, rows)
        for row, briefing in zip(rows, briefings, strict=True):
            state = _Row()
            self._state[int(row)] = state
            count = len(briefing)
            path, offset, leave = np.full(count, -1), np.zeros(count), np.zeros(count)
            for group in groups_of(briefing, leaders_in(briefing)):
                found = self._path(briefing, group, state)
                if found is not None:
                    members = group.members
                    path[members] = len(state.paths)
                    offset[members] = places_in_corridor(
                        found, briefing.start[members], self.config.spread
                    )
                    leave[members] = turn_offs(found, briefing.goal[members], self.config.leaving)
                    state.paths[group.leader] = found
            state.team = briefing.team.copy()
            self.paths[int(row)] = state.paths
            self._table.put(
                int(row), path=path + 1, offset=offset, leave=leave,
                radius=briefing.radius, progress=np.zeros(count),
            )  # fmt: skip
        self._flat = _Flat({row: list(s.paths.values()) for row, s in self._state.items()})

    def act(self, observation: Observation) -> FloatArray:
        shape = observation.active.shape
        rows, agents, n = observation.rows, shape[1], shape[0] * shape[1]
        columns = {
            name: np.ascontiguousarray(self._table.take(name, rows, agents)).reshape(n)
            for name in ("path", "offset", "leave", "radius", "progress")
        }
        base = np.array([self._flat.base[int(row)] for row in rows])
        path = np.where(columns["path"] > 0, columns["path"] - 1 + np.repeat(base, agents), -1)
        edges = observation.edges or no_edges(*shape)
        target, met = observation.goal.reshape(n, 2).copy(), np.zeros(n, np.int8)
        run_rows(
            march, n, observation.active.reshape(n), observation.position.reshape(n, 2),
            observation.goal.reshape(n, 2), columns["radius"], path, columns["offset"],
            columns["leave"], self._flat.first, self._flat.point, self._flat.arc,
            self.config.lookahead, self.config.spread, edges.start.reshape(n, -1, 2),
            edges.end.reshape(n, -1, 2), edges.count.reshape(n), columns["progress"], target, met,
            least=LEAST,
        )  # fmt: skip
        self._table.write("progress", rows, columns["progress"].reshape(shape))
        if met.any():
            self._note(observation, met.reshape(shape))
        return self._avoidance.velocity(observation, target.reshape(*shape, 2))

    def remarks(self, row: int) -> Sequence[str]:
        return self._state[row].remarks()

    def _path(self, briefing: Briefing, group: Group, state: "_Row") -> GuidingPath | None:
        """Return the group's path, of the file or else of the rehearsals; None with a remark."""
        name = f"team {int(briefing.team[group.leader])}"
        if self._given:
            apart, best = min(
                ((misfit(path, briefing, group.leader), k) for k, path in enumerate(self._given)),
                key=lambda found: (sum(found[0]), found[1]),
            )
            if max(apart) <= self.config.fit:
                return self._given[best]
            state.messages.append(
                f"no path of {self.config.path} leads from the start to the goal of the leader of"
                f" {name}: the nearest begins {apart[0]:.1f} m and ends {apart[1]:.1f} m away"
            )
        if not briefing.rehearsals:
            state.messages.append(f"no rehearsal for {name}: it goes straight to its goals")
            return None
        radius, tolerance = float(briefing.radius[group.leader]), float(self.config.tolerance)
        hits = self.config.fallback == "collided"
        found = best_path(briefing.rehearsals, group.leader, radius, tolerance, hits)
        if found is None or not found.succeeded:
            state.messages.append(_unled(briefing, group.leader, name, found is not None))
        return found

    def _note(self, observation: Observation, met: np.ndarray) -> None:
        """Record when and where a path was first blocked, and how many members were cut off."""
        for b in np.flatnonzero(met.any(axis=1)):
            state = self._state[int(observation.rows[b])]
            for kind in (BLOCKED, CUT_OFF):
                for agent in np.flatnonzero(met[b] == kind):
                    state.meet(kind, int(agent), float(observation.time[b]))


class _Row:
    """The state of one world."""

    def __init__(self) -> None:
        self.paths: dict[int, GuidingPath] = {}  # leader → its path, in the order of the groups
        self.messages: list[str] = []
        self.team: IntArray = np.zeros(0, np.int64)
        self._met: dict[tuple[int, int], tuple[float, set[int]]] = {}

    def meet(self, kind: int, agent: int, time: float) -> None:
        """Record a member that met an unexpected obstacle."""
        key = kind, int(self.team[agent])
        self._met.setdefault(key, (time, set()))[1].add(agent)

    def remarks(self) -> list[str]:
        """Return all remarks."""
        lines = list(self.messages)
        for (kind, team), (time, members) in sorted(self._met.items()):
            subject = f"{len(members)} of team {team}"
            if kind == BLOCKED:
                lines.append(
                    f"an obstacle is on the guiding path of team {team} that was not there in the"
                    f" rehearsal: {subject} met it, first at t = {time:g} s, and went around it"
                )
            else:
                lines.append(
                    f"an obstacle is between the guiding path's end and the goals of {subject},"
                    f" which met it first at t = {time:g} s"
                )
        return lines


class _Flat:
    """The concatenated paths of all rows, as input of the kernel."""

    def __init__(self, paths: dict[int, list[GuidingPath]]) -> None:
        every = [path for own in paths.values() for path in own]
        count = np.cumsum([0, *(len(own) for own in paths.values())])
        self.base = {row: int(count[k]) for k, row in enumerate(paths)}  # row → its first path
        self.first = np.cumsum([0, *(len(path.points) for path in every)])
        self.point = np.vstack([np.zeros((0, 2)), *(path.points for path in every)])
        self.arc = np.concatenate([np.zeros(0), *(path.arc for path in every)])


def _unled(briefing: Briefing, leader: int, name: str, follows: bool) -> str:
    """Return a remark on a leader without success: the reasons, and the behaviour of its group."""
    place = [(r, k) for r in briefing.rehearsals for k in np.flatnonzero(r.agent == leader)]
    hit = sum(bool(r.collided[k]) for r, k in place)
    late = sum(bool(np.isnan(r.arrival[k]) and not r.collided[k]) for r, k in place)
    then = "follows a trajectory with a collision" if follows else "goes straight to its goals"
    return (
        f"the leader of {name} succeeded in none of {len(place)} rehearsals ({hit} with a"
        f" collision, {late} not arrived): its group {then}"
    )
