"""A replay: episodes that a browser plays side by side and in step."""

import os
import webbrowser
from collections.abc import Sequence
from functools import cached_property
from html import escape
from os import PathLike
from pathlib import Path
from typing import Any

from benchnav.api.text_table import written
from benchnav.episode.episode import Episode as Record
from benchnav.errors import UsageError

SUFFIX = ".html"


class Replay:
    """One page with everything in it: it opens from disk without a network."""

    def __init__(self, records: Sequence[Record], agents: Sequence[int] | None = None) -> None:
        """Take 1 to 9 episodes; ``agents`` are those whose senses and charts are held."""
        self._records = tuple(records)
        self._agents = agents

    @cached_property
    def scenes(self) -> list[dict[str, Any]]:
        """The content of the page, one entry an episode."""
        import numpy as np

        from benchnav.viewer.replay.scene import scene

        for record in self._records:
            _require_agents(self._agents, len(record.world.agents))
        chosen = None if self._agents is None else np.array(self._agents, np.int64)
        return [scene(record, chosen) for record in self._records]

    @cached_property
    def html(self) -> str:
        """The page."""
        from benchnav.viewer.replay.page import replay_page

        return replay_page(self.scenes)

    def save(self, path: "str | PathLike[str]") -> Path:
        """Write the page to a file that ends in .html, and return its path.

        Raises UsageError for another ending, StoreError if the file cannot be written.
        """
        target = Path(path)
        if target.suffix.lower() != SUFFIX:
            raise UsageError(f"The file of a replay must end in {SUFFIX}. Got {target} instead.")
        written(self.html, target)
        return target

    def __repr__(self) -> str:
        names = ", ".join(record.identity.navigator for record in self._records)
        first = self._records[0].identity
        return f"Replay({names} in {first.scenario!r}, track={first.track!r}, seed={first.seed})"

    def _repr_html_(self) -> str:
        return (
            f'<iframe srcdoc="{escape(self.html)}" style="width: 100%; height: 640px; border: 0"'
            ' title="replay"></iframe>'
        )


def page_name(*words: str) -> str:
    """Return a file name made of ``words``, in letters that every system allows."""
    text = "-".join(words)
    return "".join(c if c.isalnum() or c in "-_." else "-" for c in text)[:120] + SUFFIX


def open_in_browser(path: Path) -> bool:
    """Open a page if this session has a display; return whether a browser took it."""
    has_display = os.name == "nt" or any(os.environ.get(n) for n in ("DISPLAY", "WAYLAND_DISPLAY"))
    return has_display and webbrowser.open(path.resolve().as_uri())


def _require_agents(agents: Sequence[int] | None, count: int) -> None:
    wrong = [agent for agent in agents or () if not 0 <= agent < count]
    if wrong:
        raise UsageError(f"Agents are numbered from 0 to {count - 1} here. Got {wrong[0]} instead.")
