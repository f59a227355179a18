"""Pictures of worlds with the places of first collisions, and the numbers of obstacles."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from functools import partial
from html import escape
from typing import TYPE_CHECKING

from benchnav.arena.solid import Kind
from benchnav.arena.world import World
from benchnav.drawing.palette import FILL, INK, PAPER, TEAMS
from benchnav.report.analysis.episode_summary import Collision
from benchnav.report.analysis.partner import obstacles_of
from benchnav.report.line_style import LineStyle
from benchnav.text.plural import counted
from benchnav.text.visible import visible
from benchnav.viewer.svg import world_svg

if TYPE_CHECKING:
    from markupsafe import Markup

MOST_MARKS = 60  # of one picture
MARK = 0.012  # half the size of a cross, as a share of the longer side of the arena
LETTER = 0.05  # the size of numbers, likewise
HATCH = 0.012  # the distance of the lines in moving obstacles, likewise
_PAINT = re.compile(r'(fill|stroke)="(#[0-9a-f]{6})"')
Hit = tuple[str, Collision]
"""A navigator, and the collision of one of its agents."""


def world_picture(
    world: World, hits: Sequence[Hit], labelled: Collection[str], styles: Mapping[str, LineStyle]
) -> Markup:
    """Return the picture of a world as SVG.

    Args:
        world: the world.
        hits: collisions in this world; at most `MOST_MARKS` are drawn, in equal shares for
            navigators.
        labelled: names of obstacles and walls (`obstacles_of`) whose numbers are shown.
        styles: the style of each navigator.
    """
    from markupsafe import Markup

    x0, y0, x1, y1 = world.bounds
    side = max(x1 - x0, y1 - y0)
    drawn = _first_of_each(hits)[:MOST_MARKS]
    marks = [_mark(*hit, MARK * side, styles[hit[0]].color) for hit in drawn]
    size = f"{HATCH * side:.3g}"
    scene = _PAINT.sub(
        partial(_neutral, f"url(#moving-{size})"),
        world_svg(world, _labels(world, labelled, LETTER * side)),
    )
    body = scene.removesuffix("</g></svg>")
    return Markup(f"{body}{_hatch(size)}{''.join(marks)}</g></svg>")  # noqa: S704


def _neutral(hatch: str, paint: re.Match[str]) -> str:
    """Return a colour that is not the colour of a navigator, in place of one that may be.

    Agents become white discs with dark edges, and moving obstacles are hatched.
    """
    name, color = paint.groups()
    if color in TEAMS:
        color = PAPER if name == "fill" else INK
    elif color == FILL[Kind.DYNAMIC]:
        color = hatch if name == "fill" else INK
    return f'{name}="{color}"'


def _hatch(size: str) -> str:
    """Return the pattern of moving obstacles; equal ones in a page share an identifier."""
    return (
        f'<defs><pattern id="moving-{size}" patternUnits="userSpaceOnUse" width="{size}"'
        f' height="{size}" patternTransform="rotate(45)"><rect width="{size}"'
        f' height="{size}" fill="#e3e7eb"/><rect width="{float(size) / 3:.3g}"'
        f' height="{size}" fill="{INK}"/></pattern></defs>'
    )


def _first_of_each(hits: Sequence[Hit]) -> list[Hit]:
    """Return the earliest collision of each navigator, then the second of each, and so on."""
    counts = Counter[str]()
    ordered = []
    for hit in sorted(hits, key=lambda hit: hit[1].time):
        counts[hit[0]] += 1
        ordered.append((counts[hit[0]], hit))
    ordered.sort(key=lambda each: each[0])  # stable
    return [hit for _, hit in ordered]


def hits_text(count: int) -> str:
    """Return the number of collisions in a world, and how many of them are drawn."""
    text = counted(count, "first collision")
    return text if count <= MOST_MARKS else f"{text}, {MOST_MARKS} of them drawn"


def _mark(navigator: str, hit: Collision, size: float, color: str) -> str:
    """Return a cross with the navigator, the partner and the time as its title."""
    x, y = hit.place
    text = escape(visible(f"{navigator}: {hit.partner}, {hit.time:.1f} s"))
    return (
        f'<path d="M{x - size:.2f} {y - size:.2f}l{2 * size:.3g} {2 * size:.3g}m0 {-2 * size:.3g}'
        f'l{-2 * size:.3g} {2 * size:.3g}" stroke="{color}" stroke-width="{size / 1.6:.2g}">'
        f"<title>{text}</title></path>"
    )


def _labels(world: World, labelled: Collection[str], size: float) -> Iterator[str]:
    """Yield the numbers of obstacles, upright although y points upwards."""
    for name, (x, y), _ in obstacles_of(world):
        number = name.rpartition(" ")[2]
        if name in labelled and number.isdigit():
            yield (
                f'<text transform="translate({x:.2f} {y:.2f}) scale(1 -1)" font-size="{size:.3g}"'
                ' text-anchor="middle" dominant-baseline="central" font-family="sans-serif"'
                f' stroke="#fff" stroke-width="{size / 5:.2g}" paint-order="stroke">{number}</text>'
            )
