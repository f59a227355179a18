"""Draw the sizes of a team's bodies."""

import numpy as np

from benchnav.arrays import FloatArray
from benchnav.generation.teams import draw_numbers
from benchnav.scenario.footprint import Capsule, RoundedBox
from benchnav.scenario.team import Team


def draw_bodies(team: Team, count: int, rng: np.random.Generator) -> dict[str, FloatArray]:
    """Return the columns `radius`, and for other shapes than discs those of the shape, (count,)."""
    shape = team.footprint
    if team.disc_radius is not None:
        return {"radius": draw_numbers(team.disc_radius, count, rng)}
    if not isinstance(shape, Capsule | RoundedBox):
        raise TypeError(f"A team must have a radius or a footprint; got {shape!r}.")
    length = 0.5 * draw_numbers(shape.length, count, rng)
    width = 0.5 * draw_numbers(shape.width, count, rng)
    corner = width.copy()
    if isinstance(shape, RoundedBox):
        corner = draw_numbers(shape.corner_radius, count, rng)
    x, y = length - corner, width - corner
    return {
        "radius": np.sqrt(x * x + y * y) + corner,
        "half_length": length, "half_width": width, "rounding": corner,
    }  # fmt: skip
