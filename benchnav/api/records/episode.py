"""An episode: the record of one run of one navigator in one world."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from benchnav.api.output.text_table import key_value_html
from benchnav.arena.agents import Role
from benchnav.arrays import BoolArray
from benchnav.episode.episode import Episode as Record
from benchnav.episode.episode import Status
from benchnav.errors import UsageError, did_you_mean
from benchnav.metrics.attempt_ends import end_counts
from benchnav.metrics.measure import all_metrics, load_metric
from benchnav.metrics.metric import evaluate
from benchnav.metrics.quantities.trajectory import cut
from benchnav.scenario.condition import EXACT
from benchnav.text.plural import counted

if TYPE_CHECKING:
    import pandas as pd
    import pedpy
    import shapely

    from benchnav.api.records.replay import Replay
    from benchnav.verify.own_map import Origin


class Episode:
    """States, commands and collisions of all agents. `record` holds them as arrays."""

    def __init__(self, record: Record, origin: "Origin | None" = None) -> None:
        self.record = record  # the plain record
        self.origin = origin  # how it was made, to run its navigator again; None: unknown

    @property
    def navigator(self) -> str:
        """The label of the navigator."""
        return self.record.identity.navigator

    @property
    def scenario(self) -> str:
        """The scenario with its version."""
        return self.record.identity.scenario

    @property
    def track(self) -> str:
        """The knowledge track."""
        return self.record.identity.track

    @property
    def perception(self) -> str:
        """How the navigator sensed: exact or noisy."""
        return self.record.identity.perception

    @property
    def seed(self) -> int:
        """The seed of the world."""
        return self.record.identity.seed

    @property
    def duration(self) -> float:
        """Seconds until the episode ended."""
        return float(self.record.times[-1])

    @property
    def failure(self) -> str:
        """Why the navigator failed in this world; "" where it did not."""
        return self.record.failure

    @property
    def undisturbed(self) -> "Episode | None":
        """The episode in the same world without the evaluated agents; None where there is none.

        There is one where background navigators drive people, if the suite runs undisturbed worlds.
        """
        other = self.record.undisturbed() if self.record.undisturbed is not None else None
        return None if other is None else Episode(other)

    @property
    def roles(self) -> tuple[str, ...]:
        """The roles that are scored: leader, follower."""
        agents = self.record.world.agents
        found = {int(role) for role in agents.role[agents.evaluated]}
        return tuple(role.name.lower() for role in Role if int(role) in found)

    def metric(self, name: str, role: str | None = None) -> float:
        """Return the mean of a metric over the agents that are scored; NaN where it is undefined.

        Args:
            name: of a metric, for example "success"; ``benchnav list metrics`` shows all.
            role: leader or follower; needed where agents of both are scored.
        """
        metric = load_metric(name)
        return evaluate(metric, self.record, self._members(role))[0]

    def metrics(self, role: str | None = None) -> dict[str, float]:
        """Return every installed metric by name."""
        members = self._members(role)
        return {metric.name: evaluate(metric, self.record, members)[0] for metric in all_metrics()}

    def to_pandas(self) -> "pd.DataFrame":
        """Return the trajectories: time, agent, x, y, heading, vx, vy, status.

        One row for each agent and decision time from its entry on, in metres, seconds and
        radians. (vx, vy) is the mean velocity until the next row, 0 in the last one. The status
        is active, arrived, ended or failed.
        """
        import pandas as pd

        record = self.record
        velocity = np.zeros(record.position.shape)
        velocity[:-1] = cut(record).velocity.transpose(1, 0, 2)
        names = np.array([status.name.lower() for status in Status], dtype=object)
        rows = state, agent = np.nonzero(record.status != int(Status.WAITING))
        x, y = record.position[rows].T
        vx, vy = velocity[rows].T
        return pd.DataFrame(
            {
                "time": record.times[state], "agent": agent, "x": x, "y": y,
                "heading": record.heading[rows], "vx": vx, "vy": vy,
                "status": names[record.status[rows]],
            }
        )  # fmt: skip

    def to_pedpy(self) -> "pedpy.TrajectoryData":
        """Return the trajectories as a recording of PedPy, with a frame for each decision time.

        An agent that vanishes has no rows after its arrival or end.
        """
        from benchnav.api.output.export import pedpy_trajectories

        return pedpy_trajectories(self.record)

    def walkable_area(self) -> "shapely.Polygon":
        """Return the free part of the arena, for `pedpy.WalkableArea`.

        If walls divide the arena, it is the part with most of the measurement area.
        """
        from benchnav.metrics.quantities.density import walkable_area

        return walkable_area(self.record.world)

    def svg(self) -> str:
        """Return a picture of the world and of every agent's path, as SVG text."""
        from benchnav.viewer.svg import episode_svg

        return episode_svg(self.record)

    def replay(self, agents: "Sequence[int] | None" = None) -> "Replay":
        """Return a replay: it shows itself in a notebook, and `save` writes it to a file.

        Args:
            agents: those whose sensor readings and charts it holds; None: up to four, first those
                that did not succeed.
        """
        from benchnav.api.records.replay import Replay

        return Replay.of([self], agents)

    def _members(self, role: str | None) -> BoolArray:
        """(A,) the agents that are scored in a role."""
        roles = self.roles
        if role is None and len(roles) > 1:
            raise UsageError(
                f"The roles {' and '.join(roles)} are scored apart: give one of them as role."
            )
        chosen = roles[0] if role is None else role
        if chosen not in roles:
            raise UsageError(
                f"The role must be one of {', '.join(roles)}. Got {role!r} instead."
                f"{did_you_mean(chosen, roles)}"
            )
        agents = self.record.world.agents
        members: BoolArray = agents.evaluated & (agents.role == int(Role[chosen.upper()]))
        return members

    def _facts(self) -> list[tuple[str, str]]:
        record = self.record
        facts = [
            ("navigator", self.navigator), ("scenario", self.scenario), ("track", self.track),
            *([] if self.perception == EXACT else [("perception", self.perception)]),
            ("seed", str(self.seed)), ("duration", f"{self.duration:g} s"),
            ("agents", end_counts(record)),
            ("contacts", counted(len(record.contacts), "event")),
        ]  # fmt: skip
        facts += [("failure", self.failure)] if self.failure else []
        return facts + [("remark", remark) for remark in record.remarks]

    def __repr__(self) -> str:
        facts = dict(self._facts())
        noisy = "" if self.perception == EXACT else f" perception={self.perception!r},"
        ended = f"; failed: {self.failure}" if self.failure else ""
        return (
            f"Episode({self.navigator!r} in {self.scenario!r}, track={self.track!r},{noisy}"
            f" seed={self.seed}: {facts['duration']}, {facts['agents']}{ended})"
        )

    def _repr_html_(self) -> str:
        return key_value_html("Episode", self._facts()) + self.svg()
