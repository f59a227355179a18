"""A drawn world, and the paths of an episode, as SVG text."""

from collections.abc import Iterable, Iterator, Sequence

from benchnav.arena.body import absent
from benchnav.arena.outline import outline, placed
from benchnav.arena.solid import Kind, Solid, signed_area
from benchnav.arena.world import World
from benchnav.arrays import BoolArray, FloatArray
from benchnav.drawing.palette import FILL, agent_color
from benchnav.episode.episode import Episode, Status
from benchnav.world.simulation import Simulation

WIDTH = 480  # of the picture [pixels]


def world_svg(world: World, marks: Iterable[str] = ()) -> str:
    """Return a picture of a world: walls, obstacles, agents at their starts, rings at goals.

    Starts of agents that enter later are not filled. ``marks`` are SVG elements to draw above, in
    metres with y upwards.
    """
    bodies = Simulation([world]).body_position[0]
    late = world.agents.enters > 0.0
    starts = _agents(world, world.agents.start, world.agents.heading, late)
    return _svg(world, [*_scene(world, bodies), *_goals(world), *starts, *marks])


def episode_svg(episode: Episode) -> str:
    """Return a picture of an episode: the path of every agent, and the agent at its last place.

    Agents that did not enter are left out.
    """
    world = episode.world
    paths = [
        f'<polyline points="{_points(_thinned(episode.position[:, a]))}" fill="none"'
        f' stroke="{agent_color(world, a)}" stroke-width="0.08" opacity="0.7"/>'
        for a in range(len(world.agents))
    ]
    failed = episode.status[-1] != int(Status.ARRIVED)
    entered = episode.status[-1] != int(Status.WAITING)
    ends = _agents(world, episode.position[-1], episode.heading[-1], failed, entered)
    scene = _scene(world, episode.body_position[-1])
    return _svg(world, [*scene, *_goals(world), *paths, *ends])


def _svg(world: World, parts: Sequence[str]) -> str:
    x0, y0, x1, y1 = world.bounds
    margin = 0.02 * max(x1 - x0, y1 - y0)
    wide, high = x1 - x0 + 2 * margin, y1 - y0 + 2 * margin
    height = round(WIDTH * high / wide)
    view = f"{x0 - margin:g} {-y1 - margin:g} {wide:g} {high:g}"
    body = "".join(parts)
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" height="{height}"'
        f' viewBox="{view}"><rect x="{x0 - margin:g}" y="{-y1 - margin:g}" width="{wide:g}"'
        f' height="{high:g}" fill="white"/><g transform="scale(1 -1)">{body}</g></svg>'
    )


def _scene(world: World, bodies: FloatArray) -> Iterator[str]:
    """Yield walls and obstacles, with moving ones at ``bodies`` (M, 2) [m]."""
    for solid in world.solids:
        yield _solid(solid)
    for body, position in zip(world.bodies, bodies, strict=False):
        if not absent(position):
            yield _solid(body.solid.moved(position))


def _solid(solid: Solid) -> str:
    color = FILL[Kind(solid.kind)]
    if solid.is_disc:
        x, y = solid.center
        return f'<circle cx="{x:.3f}" cy="{y:.3f}" r="{solid.radius:.3f}" fill="{color}"/>'
    path = " ".join(f"M {_points(loop)} Z" for loop in solid.loops)
    filled = color if any(signed_area(loop) > 0.0 for loop in solid.loops) else "none"
    return (
        f'<path d="{path}" fill="{filled}" fill-rule="evenodd" stroke="{color}"'
        ' stroke-width="0.06"/>'
    )


def _goals(world: World) -> Iterator[str]:
    for a, (x, y) in enumerate(world.agents.goal):
        yield (
            f'<circle cx="{x:.3f}" cy="{y:.3f}" r="{world.agents.radius[a]:.3f}" fill="none"'
            f' stroke="{agent_color(world, a)}" stroke-width="0.06" stroke-dasharray="0.2 0.15"/>'
        )


def _agents(
    world: World, position: FloatArray, heading: FloatArray, hollow: BoolArray,
    drawn: BoolArray | None = None,
) -> Iterator[str]:  # fmt: skip
    """Yield agents at ``position`` (A, 2) [m], those in ``hollow`` (A,) not filled.

    ``drawn`` (A,) are the agents to draw; None: all.
    """
    for a, (x, y) in enumerate(position):
        if drawn is not None and not drawn[a]:
            continue
        fill = "#fff" if hollow[a] else agent_color(world, a)
        shape = outline(world.agents, a)
        body = f'<circle cx="{x:.3f}" cy="{y:.3f}" r="{world.agents.radius[a]:.3f}"'
        if shape is not None:
            corners = placed(shape, position[a], float(heading[a]))
            body = f'<polygon points="{_points(corners)}"'
        yield f'{body} fill="{fill}" stroke="{agent_color(world, a)}" stroke-width="0.08"/>'


def _points(points: FloatArray) -> str:
    return " ".join(f"{x:.3f},{y:.3f}" for x, y in points)


def _thinned(points: FloatArray, most: int = 400) -> FloatArray:
    return points[:: max(1, len(points) // most)]
