"""Draw the times at which agents enter the arena."""

import numpy as np

from benchnav.arrays import FloatArray
from benchnav.generation.teams import draw_numbers
from benchnav.scenario.entry import Entry, Stream


def draw_entries(entry: Entry, count: int, rng: np.random.Generator) -> FloatArray:
    """Return (count,) times [s], rising in a stream."""
    if isinstance(entry, tuple):
        return np.array(entry[:count], np.float64)
    if isinstance(entry, Stream):
        gaps = draw_numbers(entry.every, max(count - 1, 0), rng)
        return np.concatenate([[entry.begin], entry.begin + np.cumsum(gaps)])[:count]
    return draw_numbers(entry, count, rng)
