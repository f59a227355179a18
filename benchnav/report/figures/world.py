"""Pictures of worlds with the places of first collisions, and the numbers of obstacles."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from html import escape
from typing import TYPE_CHECKING

import numpy as np

from benchnav.arena.world import World
from benchnav.arrays import FloatArray
from benchnav.report.analysis.episode_summary import Collision
from benchnav.report.analysis.partner import partner_name
from benchnav.report.line_style import LineStyle
from benchnav.text.visible import visible
from benchnav.viewer.svg import world_svg

if TYPE_CHECKING:
    from markupsafe import Markup

MOST_MARKS = 60  # of one picture
MARK, LETTER = 0.012, 0.05  # radius and font size, of the longer side of the arena
Hit = tuple[str, Collision]
"""A navigator, and the collision of one of its agents."""


def world_picture(
    world: World, hits: Sequence[Hit], labelled: Collection[str], styles: Mapping[str, LineStyle]
) -> Markup:
    """Return the picture of a world as SVG.

    Args:
        world: the world.
        hits: collisions in this world; only the first `MOST_MARKS` are drawn.
        labelled: names of obstacles and walls (`partner_name`) whose numbers are shown.
        styles: the style of each navigator.
    """
    from markupsafe import Markup

    x0, y0, x1, y1 = world.bounds
    side = max(x1 - x0, y1 - y0)
    drawn = sorted(hits, key=lambda hit: hit[1].time)[:MOST_MARKS]
    marks = [_mark(*hit, MARK * side, styles[hit[0]].color) for hit in drawn]
    return Markup(world_svg(world, [*_labels(world, labelled, LETTER * side), *marks]))  # noqa: S704


def _mark(navigator: str, hit: Collision, radius: float, color: str) -> str:
    x, y = hit.place
    text = escape(visible(f"{navigator}: {hit.partner}, {hit.time:.1f} s"))
    return (
        f'<circle cx="{x:.2f}" cy="{y:.2f}" r="{radius:.3g}" fill="{color}" stroke="#fff"'
        f' stroke-width="{radius / 4:.2g}"><title>{text}</title></circle>'
    )


def _labels(world: World, labelled: Collection[str], size: float) -> Iterator[str]:
    """Yield the numbers of obstacles, upright although y points upwards."""
    for name, (x, y) in _places(world):
        number = name.rpartition(" ")[2]
        if name in labelled and number.isdigit():
            yield (
                f'<text transform="translate({x:.2f} {y:.2f}) scale(1 -1)" font-size="{size:.3g}"'
                ' text-anchor="middle" dominant-baseline="central" font-family="sans-serif"'
                f' stroke="#fff" stroke-width="{size / 5:.2g}" paint-order="stroke">{number}</text>'
            )


def _places(world: World) -> Iterator[tuple[str, FloatArray]]:
    """Yield the name and the middle (2,) [m] of every wall, obstacle and body."""
    for k, solid in enumerate(world.solids):
        ends = solid.capsules[:, :4].reshape(-1, 2)
        yield partner_name(world, int(solid.kind), k), 0.5 * (ends.min(axis=0) + ends.max(axis=0))
    for k, body in enumerate(world.bodies):
        place = np.asarray(body.law.points[0], np.float64)
        yield partner_name(world, int(body.solid.kind), -1 - k), place
