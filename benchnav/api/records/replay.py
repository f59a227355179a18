"""A replay: episodes that a browser plays side by side and in step."""

import os
import webbrowser
from collections.abc import Iterable, Sequence
from functools import cached_property
from html import escape
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from benchnav.api.output.text_table import written
from benchnav.arrays import IntArray
from benchnav.episode.episode import Episode as Record
from benchnav.errors import UsageError, did_you_mean
from benchnav.scenario.condition import EXACT, episode_name

if TYPE_CHECKING:
    from benchnav.api.records.episode import Episode
    from benchnav.verify.own_map import Origin

PAGE, GIF, FILM = ".html", ".gif", ".mp4"
MCAP, RERUN = ".mcap", ".rrd"
FIGURES = (".png", ".svg", ".pdf")
MOST = 9  # episodes side by side
SUFFIXES = (PAGE, *FIGURES, GIF, FILM, RERUN, MCAP)


class Replay:
    """One page with everything in it: it opens from disk without a network."""

    def __init__(
        self,
        records: Sequence[Record],
        agents: Sequence[int] | None = None,
        origins: "Sequence[Origin | None] | None" = None,
    ) -> None:
        """Take 1 to 9 episodes.

        Args:
            records: the episodes.
            agents: those whose sensor readings and charts the page holds; None: up to four, first
                those that did not succeed.
            origins: how each episode was made, so that the page can show the maps that its
                navigator made; None: without them.

        Raises UsageError for another number of episodes, and for an agent that there is not.
        """
        if not 1 <= len(records) <= MOST:
            raise UsageError(
                f"A replay shows 1 to {MOST} episodes side by side. Got"
                f" {len(records) or 'none'}{': choose fewer' if records else ''}."
            )
        for record in records:
            _require_agents(agents, len(record.world.agents))
        self._records = tuple(records)
        self._agents = agents
        self._origins = tuple(origins or [None] * len(self._records))

    @classmethod
    def of(cls, episodes: "Iterable[Episode]", agents: Sequence[int] | None = None) -> "Replay":
        """Return the replay of episodes of the Python API, with the maps that navigators made."""
        chosen = list(episodes)  # each is read once
        origins = [episode.origin for episode in chosen]
        return cls([episode.record for episode in chosen], agents, origins)

    @cached_property
    def html(self) -> str:
        """The page."""
        return self.page()

    def page(self, assets: str = "") -> str:
        """Return the page; ``assets`` is that of `benchnav.viewer.replay.page.replay_page`."""
        from benchnav.viewer.replay.page import replay_page
        from benchnav.viewer.replay.scene import scene

        return replay_page(
            [
                scene(record, self._chosen_agents(record), origin)
                for record, origin in zip(self._records, self._origins, strict=True)
            ],
            assets,
        )

    def save(self, path: "str | PathLike[str]", times: Sequence[float] = ()) -> Path:
        """Write the replay to a file, in the format of its suffix, and return its path.

        Args:
            path: ends in .html (a page), .gif or .mp4 (a moving picture), .png, .svg or .pdf (a
                figure), .rrd (for the Rerun viewer) or .mcap (for Foxglove). A missing folder is
                created.
            times: [s] of a figure with snapshots in a row; none: one picture with trails.

        Raises UsageError for another suffix or a wrong time, StoreError if the file cannot be
        written, MissingExtraError if a library of the format is not installed.
        """
        target = Path(path)
        suffix = target.suffix.lower()
        if suffix not in SUFFIXES:
            raise UsageError(
                f"The file of a replay must end in {', '.join(SUFFIXES)}."
                f" Got {target} instead.{did_you_mean(suffix, SUFFIXES)}"
            )
        if times and suffix not in FIGURES:
            raise UsageError(f"Times are for a figure: .png, .svg or .pdf. Got {target} instead.")
        if suffix == PAGE:
            written(self.html, target)
        elif suffix in (GIF, FILM):
            from benchnav.viewer.animation import save_gif, save_mp4

            (save_gif if suffix == GIF else save_mp4)(self._records, target)
        elif suffix in (MCAP, RERUN):
            self._save_recording(target, suffix)
        else:
            from benchnav.viewer.picture import save
            from benchnav.viewer.scene_figure import episode_figure

            save(episode_figure(self._records, times), target)
        return target

    def _save_recording(self, path: Path, suffix: str) -> None:
        """Write one episode for a 3-D viewer."""
        from benchnav.viewer.recordings.mcap_log import save_mcap
        from benchnav.viewer.recordings.rerun_log import save_rerun

        if len(self._records) > 1:
            raise UsageError(
                f"A {suffix} file holds one episode. Got {len(self._records)}: name one navigator."
            )
        (record,) = self._records
        save = save_mcap if suffix == MCAP else save_rerun
        save(record, self._chosen_agents(record), path)

    def _chosen_agents(self, record: Record) -> IntArray:
        """Return the agents (n,) whose sensor readings are shown."""
        from benchnav.viewer.replay.scene import interesting

        return interesting(record) if self._agents is None else np.array(self._agents, np.int64)

    def __repr__(self) -> str:
        every = [record.identity for record in self._records]
        first = every[0]
        if len({(one.scenario, one.track, one.perception, one.seed) for one in every}) > 1:
            names = (
                episode_name(one.navigator, one.scenario, one.track, one.perception, one.seed)
                for one in every
            )
            return f"Replay({', '.join(names)})"
        names = (one.navigator for one in every)
        noisy = "" if first.perception == EXACT else f" perception={first.perception!r},"
        return (
            f"Replay({', '.join(names)} in {first.scenario!r}, track={first.track!r},{noisy}"
            f" seed={first.seed})"
        )

    def _repr_html_(self) -> str:
        return (
            f'<iframe srcdoc="{escape(self.html)}" style="width: 100%; height: 640px; border: 0"'
            ' title="replay"></iframe>'
        )


def open_in_browser(path: Path) -> bool:
    """Open a page if this session has a display; return whether a browser took it."""
    has_display = os.name == "nt" or any(os.environ.get(n) for n in ("DISPLAY", "WAYLAND_DISPLAY"))
    return has_display and webbrowser.open(path.resolve().as_uri())


def _require_agents(agents: Sequence[int] | None, count: int) -> None:
    wrong = [agent for agent in agents or () if not 0 <= agent < count]
    if wrong:
        raise UsageError(f"Agents are numbered from 0 to {count - 1} here. Got {wrong[0]} instead.")
