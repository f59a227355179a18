"""The bodies of a table's ids: discs, or rectangles with rounded corners."""

from typing import Any

import numpy as np

from benchnav.arena.agents import Agents
from benchnav.arrays import BoolArray, FloatArray, IntArray
from benchnav.errors import TrajectoryError
from benchnav.scoring.table_file import Table

SHAPE = ("body_length", "body_width", "corner_radius")
"""Columns of a body that is not a disc. A disc has its diameter twice, and its radius."""
_SAME = 1e-6  # [m] largest difference of a radius from the scenario's
Columns = dict[str, Any]  # arrays (A,) of numbers, as `Agents` has them


def shape_of_table(table: Table, rows: IntArray) -> Columns | None:
    """Return radius and shape (A,) of the ids whose first rows are ``rows``; None without columns.

    Raises TrajectoryError for some of the three columns only, and for sizes that do not fit.
    """
    given = [name for name in SHAPE if name in table.frame]
    if not given:
        return None
    if len(given) < len(SHAPE):
        missing = ", ".join(name for name in SHAPE if name not in given)
        raise TrajectoryError(
            f"{table.path}:1: {', '.join(SHAPE)} must be given together; {missing} is missing."
        )
    length, width, corner = (table.column(name)[rows] for name in SHAPE)  # type: ignore[index]
    bad = ~((corner > 0.0) & (np.minimum(length, width) >= 2.0 * corner - _SAME))
    if bad.any():
        row = int(rows[np.argmax(bad)])
        raise TrajectoryError(
            f"{table.place(row)}: corner_radius must be > 0 m and at most half of body_length and"
            f" body_width; got {corner[bad][0]:g}. Correct it."
        )
    x, y = np.maximum(0.5 * length - corner, 0.0), np.maximum(0.5 * width - corner, 0.0)
    disc = (x <= _SAME) & (y <= _SAME)
    shape = {"half_length": x + corner, "half_width": y + corner, "rounding": corner}
    shape = {name: np.where(disc, 0.0, value) for name, value in shape.items()}
    return {"radius": np.sqrt(x * x + y * y) + corner, **shape}


def shape_of_agents(agents: Agents, match: IntArray, radius: FloatArray) -> Columns:
    """Return the shape (A,) of the scenario's agents; an id of another ``radius`` is a disc."""
    own: BoolArray = np.abs(agents.radius[match] - radius) <= _SAME
    return {
        name: np.where(own, getattr(agents, name)[match], 0.0)
        for name in ("half_length", "half_width", "rounding")
    }


def shape_columns(agents: Agents) -> Columns:
    """Return the columns `SHAPE` (A,) of a table; none if all bodies are discs."""
    shaped = agents.rounding > 0.0
    if not shaped.any():
        return {}
    return {
        "body_length": np.where(shaped, 2.0 * agents.half_length, 2.0 * agents.radius),
        "body_width": np.where(shaped, 2.0 * agents.half_width, 2.0 * agents.radius),
        "corner_radius": np.where(shaped, agents.rounding, agents.radius),
    }
