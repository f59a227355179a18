"""Episodes that are made up rather than simulated."""

import numpy as np

from benchnav.episode.episode import Contacts, Episode, Identity, Timings


def straight_episode(world, steps):
    """Every agent goes straight to its goal, with a little noise, and nobody touches anything."""
    crew, rng = world.agents, np.random.default_rng(1)
    share = np.linspace(0.0, 1.0, steps + 1)[:, None, None]
    position = crew.start + share * (crew.goal - crew.start)
    position = position + rng.normal(0.0, 0.02, position.shape)
    heading = np.broadcast_to(np.arctan2(*(crew.goal - crew.start).T[::-1]), position.shape[:2])
    empty = np.zeros(0)
    none = Contacts(
        empty.astype(int), empty.astype(np.int8), empty.astype(int), empty, empty, empty, empty,
        empty.astype(bool),
    )  # fmt: skip
    command = np.zeros((steps, len(crew), 2))
    return Episode(
        Identity("tests/crowd@1", "0", "test", 0, "known", "made-up"), world, position,
        heading.copy(), np.zeros(position.shape[:2], np.int8), command, command,
        np.zeros((steps + 1, 0, 2)), np.full(len(crew), np.nan), none, Timings(empty, 0.0, 1),
    )  # fmt: skip
