"""An episode as a recording for the Rerun viewer: a 3-D scene and charts over time.

Entities: ``arena`` and ``bodies/M`` (meshes), ``agents`` (cylinders), ``shapes/A``
(meshes of agents that are not discs), ``trails/A``, ``hits/A`` (ray
hits) and ``charts/collision_probability/A`` of the agents whose senses are recorded. x and y lie
on the floor [m], z is up; the timeline ``time`` is that of the episode [s].
"""

from pathlib import Path
from typing import Any

import numpy as np

from benchnav.arena.body import absent
from benchnav.arena.solid import Kind
from benchnav.arrays import IntArray
from benchnav.drawing.palette import FILL, agent_color, rgb
from benchnav.episode.episode import Episode
from benchnav.errors import MissingExtraError
from benchnav.metrics.quantities.episode_analysis import analyse
from benchnav.scenario.condition import condition
from benchnav.system.plain_file import writing
from benchnav.viewer.recordings.extrusion import AGENT_HEIGHT, extrude, extrude_agents
from benchnav.viewer.replay.senses import Senses, sensed

_FLOOR = 0.02  # [m] trails are drawn so far above the floor
_EYE = 0.3  # [m] height of rays


def save_rerun(episode: Episode, agents: IntArray, path: Path) -> None:
    """Write an episode, with the sensor readings of ``agents`` (n,), to a file for Rerun.

    Raises MissingExtraError without the library, StoreError if the file cannot be written.
    """
    try:
        import rerun
    except ImportError as error:
        raise MissingExtraError("A Rerun file", "rerun") from error
    with writing(path):
        path.open("wb").close()  # the library does not report an error
    identity = episode.identity
    where = condition(identity.track, identity.perception)
    stream = rerun.RecordingStream(
        "benchnav",
        recording_id=f"{identity.navigator}-{identity.scenario}-{where}-{identity.seed}",
    )
    stream.save(str(path))
    _log_arena(rerun, stream, episode)
    _log_motion(rerun, stream, episode)
    found = sensed(episode, agents)
    if found is not None:
        _log_senses(rerun, stream, episode, found)
    stream.flush()
    stream.disconnect()


def _log_arena(rerun: Any, stream: Any, episode: Episode) -> None:
    world = episode.world
    stream.log("/", rerun.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
    for n, solid in enumerate(world.solids):
        mesh = _mesh(rerun, extrude(solid, world.bounds), rgb(FILL[Kind(solid.kind)]))
        stream.log(f"arena/{n}", mesh, static=True)
    for m, body in enumerate(world.bodies):
        mesh = _mesh(rerun, extrude(body.solid, world.bounds), rgb(FILL[Kind(body.solid.kind)]))
        stream.log(f"bodies/{m}", mesh, static=True)


def _mesh(rerun: Any, mesh: Any, color: tuple[float, float, float]) -> Any:
    return rerun.Mesh3D(
        vertex_positions=mesh.vertices, triangle_indices=mesh.triangles,
        albedo_factor=[*color, 1.0],
    )  # fmt: skip


def _log_motion(rerun: Any, stream: Any, episode: Episode) -> None:
    agents, has_body = episode.world.agents, analyse(episode).trajectories.has_body
    colors = np.array([rgb(agent_color(episode.world, a)) for a in range(len(agents))])
    meshes = extrude_agents(episode.world)
    for a, mesh in enumerate(meshes):
        if mesh is not None:
            shape = _mesh(rerun, mesh, rgb(agent_color(episode.world, a)))
            stream.log(f"shapes/{a}", shape, static=True)
    for t, time in enumerate(episode.times):
        stream.set_time("time", duration=float(time))
        for m, place in enumerate(episode.body_position[t]):
            if absent(place):  # its mesh is logged once: only a scale of zero hides it
                stream.log(f"bodies/{m}", rerun.Transform3D(scale=0.0))
            else:
                stream.log(f"bodies/{m}", rerun.Transform3D(translation=[*place, 0.0]))
        here = np.flatnonzero(has_body[:, t])
        for a in [a for a, mesh in enumerate(meshes) if mesh is not None]:
            seen = has_body[a, t]
            place = [*episode.position[t, a], 0.0 if seen else -1e3]  # below the floor: absent
            turn = rerun.RotationAxisAngle([0.0, 0.0, 1.0], radians=float(episode.heading[t, a]))
            stream.log(f"shapes/{a}", rerun.Transform3D(translation=place, rotation=turn))
        trailed, here = here, here[[meshes[a] is None for a in here]]
        centers = np.column_stack(
            [episode.position[t, here], np.full(len(here), 0.5 * AGENT_HEIGHT)]
        )
        discs = rerun.Cylinders3D(
            lengths=np.full(len(here), AGENT_HEIGHT), radii=agents.radius[here], centers=centers,
            colors=(255 * colors[here]).astype(np.uint8), fill_mode="solid",
            labels=[str(a) for a in here], show_labels=False,
        )  # fmt: skip
        stream.log("agents", discs)
        stream.log("trails", _trails(rerun, episode, t, trailed, colors))


def _trails(rerun: Any, episode: Episode, t: int, here: IntArray, colors: Any) -> Any:
    first = max(0, t - round(6.0 / episode.world.clock.dt))
    lines = [
        np.column_stack([episode.position[first : t + 1, a], np.full(t + 1 - first, _FLOOR)])
        for a in here
    ]
    return rerun.LineStrips3D(lines, colors=(255 * colors[here]).astype(np.uint8), radii=0.03)


def _log_senses(rerun: Any, stream: Any, episode: Episode, found: Senses) -> None:
    for t, time in enumerate(episode.times):
        stream.set_time("time", duration=float(time))
        for n, agent in enumerate(found.agents):
            if found.probability is not None:
                scalar = rerun.Scalars(float(found.probability[t, n]))
                stream.log(f"charts/collision_probability/{agent}", scalar)
            if found.distance is None or found.kind is None:
                continue
            hit = found.kind[t, n] != int(Kind.NOTHING)
            angle = episode.heading[t, agent] + found.angle[hit]
            ends = episode.position[t, agent] + found.distance[t, n, hit, None] * np.column_stack(
                [np.cos(angle), np.sin(angle)]
            )
            points = np.column_stack([ends, np.full(len(ends), _EYE)])
            stream.log(f"hits/{agent}", rerun.Points3D(points, radii=0.06, colors=[204, 0, 51]))
