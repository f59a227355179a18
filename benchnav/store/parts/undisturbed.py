"""Undisturbed episodes: a scenario's worlds without the evaluated agents, in a cell of their own.

All navigators share them: each of their episodes is compared with the one of its seed.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from benchnav.episode.episode import Episode
from benchnav.store.parts.part import Part


@dataclass
class UndisturbedEpisodes:
    """Returns the undisturbed episode of a seed. Reads a part when needed, and keeps the last."""

    parts: Sequence[Part]
    _kept: dict[int, Episode] = field(default_factory=dict, repr=False)

    def __call__(self, seed: int) -> Episode | None:
        """Return the episode; None if it is not stored. Raises CorruptPartError."""
        if seed not in self._kept:
            found = [part for part in self.parts if seed in part.seeds]
            self._kept = {e.identity.seed: e for part in found for e in part.episodes()}
        return self._kept.get(seed)

    def __getstate__(self) -> dict[str, Any]:
        """Leave out the kept episodes: another process reads those that it needs."""
        return {"parts": self.parts, "_kept": {}}
