"""An episode as an MCAP file in Foxglove's schemas.

Topics: ``/arena`` and ``/bodies`` (foxglove.SceneUpdate), ``/agents`` (foxglove.PosesInFrame and,
for their discs, foxglove.SceneUpdate on ``/agents/discs``), and ``/scan/N`` (foxglove.LaserScan)
of the agents whose senses are recorded. Everything is in the frame ``world``: x and y on the floor
[m], z up. The log starts at time 0.
"""

import math
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from benchnav.arena.body import absent
from benchnav.arena.solid import Kind
from benchnav.arrays import FloatArray, IntArray
from benchnav.drawing.palette import FILL, agent_color, rgb
from benchnav.episode.episode import Episode
from benchnav.errors import MissingExtraError
from benchnav.metrics.quantities.episode_analysis import analyse
from benchnav.system.plain_file import writing
from benchnav.viewer.recordings.extrusion import AGENT_HEIGHT, Mesh, extrude, extrude_agents
from benchnav.viewer.replay.senses import sensed

FRAME = "world"


def save_mcap(episode: Episode, agents: IntArray, path: Path) -> None:
    """Write an episode, with the scans of ``agents`` (n,), to an MCAP file.

    Raises MissingExtraError without the libraries, StoreError if the file cannot be written.
    """
    try:
        from mcap_protobuf.writer import Writer
    except ImportError as error:
        raise MissingExtraError("An MCAP file", "mcap") from error
    log = _Log(episode, agents)
    with writing(path), path.open("wb") as stream, Writer(stream) as writer:
        for time, topic, message in log.messages():
            nanoseconds = round(time * 1e9)
            writer.write_message(topic, message, nanoseconds, nanoseconds)


class _Log:
    """The messages of one episode."""

    def __init__(self, episode: Episode, agents: IntArray) -> None:
        import foxglove_schemas_protobuf as schemas

        self._schemas = schemas
        self._episode = episode
        self._scans = sensed(episode, agents)
        self._shapes = extrude_agents(episode.world)
        self._has_body = analyse(episode).trajectories.has_body

    def messages(self) -> Iterable[tuple[float, str, Any]]:
        """Yield (time [s], topic, message)."""
        world = self._episode.world
        arena = [
            self._mesh(f"solid-{n}", extrude(solid, world.bounds), rgb(FILL[Kind(solid.kind)]))
            for n, solid in enumerate(world.solids)
        ]
        yield 0.0, "/arena", self._scene(0.0, arena)
        shapes = [extrude(body.solid, world.bounds) for body in world.bodies]
        away = absent(self._episode.body_position)
        for t, time in enumerate(self._episode.times):
            bodies = [
                self._mesh(
                    f"body-{m}", Mesh(shape.vertices + _place(self._episode.body_position[t, m]),
                                      shape.triangles),
                    rgb(FILL[Kind(world.bodies[m].solid.kind)]),
                )
                for m, shape in enumerate(shapes)
                if not away[t, m]
            ]  # fmt: skip
            if shapes:
                yield time, "/bodies", self._scene(time, bodies)
            yield time, "/agents", self._poses(t, time)
            yield time, "/agents/discs", self._scene(time, self._discs(t))
            yield from self._laser_scans(t, time)

    def _make(self, name: str, **values: Any) -> Any:
        from importlib import import_module

        module = import_module(f"{self._schemas.__name__}.{name}_pb2")
        return getattr(module, name)(**values)

    def _scene(self, time: float, entities: list[Any]) -> Any:
        for entity in entities:
            entity.timestamp.FromNanoseconds(round(time * 1e9))
        return self._make("SceneUpdate", entities=entities)

    def _mesh(
        self, name: str, mesh: Mesh, color: tuple[float, float, float], pose: Any = None
    ) -> Any:
        triangles = self._make(
            "TriangleListPrimitive",
            points=[self._make("Point3", x=x, y=y, z=z) for x, y, z in mesh.vertices],
            indices=mesh.triangles.ravel().tolist(), color=self._color(color),
            pose=self._pose() if pose is None else pose,
        )  # fmt: skip
        return self._make("SceneEntity", id=name, frame_id=FRAME, triangles=[triangles])

    def _discs(self, t: int) -> list[Any]:
        """Return cylinders or meshes for the agents that are present; they come and go."""
        episode, agents = self._episode, self._episode.world.agents
        here = np.flatnonzero(self._has_body[:, t])
        out = []
        for a in here:
            shape = self._shapes[a]
            if shape is not None:
                color = rgb(agent_color(episode.world, int(a)))
                pose = self._pose(episode.position[t, a], 0.0, episode.heading[t, a])
                entity = self._mesh(f"agent-{a}", shape, color, pose)
                entity.lifetime.FromNanoseconds(round(episode.world.clock.dt * 1.5e9))
                out.append(entity)
                continue
            size = self._make(
                "Vector3", x=2 * agents.radius[a], y=2 * agents.radius[a], z=AGENT_HEIGHT
            )
            cylinder = self._make(
                "CylinderPrimitive", size=size, bottom_scale=1.0, top_scale=1.0,
                color=self._color(rgb(agent_color(episode.world, int(a)))),
                pose=self._pose(episode.position[t, a], 0.5 * AGENT_HEIGHT, episode.heading[t, a]),
            )  # fmt: skip
            entity = self._make(
                "SceneEntity", id=f"agent-{a}", frame_id=FRAME, cylinders=[cylinder]
            )
            entity.lifetime.FromNanoseconds(round(episode.world.clock.dt * 1.5e9))
            out.append(entity)
        return out

    def _poses(self, t: int, time: float) -> Any:
        episode = self._episode
        poses = [
            self._pose(place, 0.0, float(heading))
            for place, heading in zip(episode.position[t], episode.heading[t], strict=True)
        ]
        message = self._make("PosesInFrame", frame_id=FRAME, poses=poses)
        message.timestamp.FromNanoseconds(round(time * 1e9))
        return message

    def _laser_scans(self, t: int, time: float) -> Iterable[tuple[float, str, Any]]:
        scans = self._scans
        if scans is None or scans.distance is None or scans.kind is None:
            return
        for n, agent in enumerate(scans.agents):
            if not self._has_body[agent, t]:
                continue
            ranges = np.where(scans.kind[t, n] == int(Kind.NOTHING), math.inf, scans.distance[t, n])
            message = self._make(
                "LaserScan", frame_id=FRAME, start_angle=float(scans.angle[0]),
                end_angle=float(scans.angle[-1]), ranges=ranges.tolist(),
                pose=self._pose(
                    self._episode.position[t, agent], 0.3, self._episode.heading[t, agent]
                ),
            )  # fmt: skip
            message.timestamp.FromNanoseconds(round(time * 1e9))
            yield time, f"/scan/{agent}", message

    def _pose(self, place: Any = (0.0, 0.0), z: float = 0.0, heading: float = 0.0) -> Any:
        turn = self._make(
            "Quaternion", x=0.0, y=0.0, z=math.sin(0.5 * heading), w=math.cos(0.5 * heading)
        )
        position = self._make("Vector3", x=float(place[0]), y=float(place[1]), z=z)
        return self._make("Pose", position=position, orientation=turn)

    def _color(self, color: tuple[float, float, float]) -> Any:
        return self._make("Color", r=color[0], g=color[1], b=color[2], a=1.0)


def _place(offset: FloatArray) -> FloatArray:
    return np.array([offset[0], offset[1], 0.0])
