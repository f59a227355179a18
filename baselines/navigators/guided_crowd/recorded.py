"""Guiding paths from the rehearsals of a run folder, and their picture."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from benchnav.arena import Kind, World
from benchnav.episode import Episode
from benchnav.errors import MissingExtraError
from benchnav.runner.rollouts.rehearsal import granted

from .guiding_path import GuidingPath, best_path

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def paths_of(rehearsals: Sequence[Episode], tolerance: float = 0.05) -> tuple[GuidingPath, ...]:
    """Return the guiding paths from the rehearsals of one world, without unsuccessful leaders.

    ``rehearsals`` are episodes of `benchnav.store.runs.reading.read_rehearsals`, all of
    one navigator, scenario, track and seed.
    """
    agents = rehearsals[0].world.agents
    granted_rehearsals = [granted(episode, np.arange(len(agents))) for episode in rehearsals]
    found = [
        best_path(granted_rehearsals, int(agent), float(agents.radius[agent]), tolerance)
        for agent in np.flatnonzero(agents.evaluated)
    ]
    return tuple(path for path in found if path is not None)


def draw_paths(paths: Sequence[GuidingPath], axes: "Axes", world: World | None = None) -> None:
    """Draw guiding paths, each in its own colour, over the walls and obstacles of ``world``.

    Raises MissingExtraError if matplotlib is not installed.
    """
    try:
        from matplotlib.patches import Circle, Polygon
    except ImportError as error:
        raise MissingExtraError("A picture of guiding paths", "view") from error
    for solid in () if world is None else world.solids:
        filled = solid.kind != Kind.WALL  # of a walled arena the outside is solid
        for loop in solid.loops:
            axes.add_patch(
                Polygon(loop, closed=True, fill=filled, facecolor="0.7", edgecolor="0.3")
            )
        if solid.is_disc:
            axes.add_patch(Circle(solid.center, solid.radius, facecolor="0.7", edgecolor="0.3"))
    for k, path in enumerate(paths):
        (line,) = axes.plot(*path.points.T, label=f"{k}: {path.duration:.1f} s")
        axes.plot(*path.points[-1], "o", color=line.get_color())
    axes.set_aspect("equal")
    axes.set_xlabel("x [m]")
    axes.set_ylabel("y [m]")
