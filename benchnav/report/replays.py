"""The replay pages of a report: made while the runs are read, so that no episode is read twice."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from benchnav.episode.episode import Episode
from benchnav.report.failures import Cell, Failures
from benchnav.report.page import ASSETS, href, replay_path
from benchnav.viewer.replay.page import replay_page
from benchnav.viewer.replay.scene import interesting, scene


class ReplayWriter:
    """Writes the replays of chosen episodes into a folder."""

    def __init__(self, chosen: Sequence[Failures], folder: Path) -> None:
        self._chosen = {(f.navigator, f.scenario, f.track): f.seed for f in chosen}
        self._folder = folder
        self.written: set[Cell] = set()

    def __call__(self, episode: Episode, tracks: tuple[str, ...]) -> None:
        """Write the replays of an episode that stands for ``tracks``, if they are chosen."""
        identity = episode.identity
        for track in tracks:
            cell = identity.navigator, identity.scenario, track
            if self._chosen.get(cell) == identity.seed and cell not in self.written:
                self._write(replace(episode, identity=replace(identity, track=track)))
                self.written.add(cell)

    def _write(self, episode: Episode) -> None:
        identity = episode.identity
        path = replay_path(identity.navigator, identity.scenario, identity.track, identity.seed)
        target = self._folder / path
        target.parent.mkdir(exist_ok=True)
        page = replay_page([scene(episode, interesting(episode))], href(path, ASSETS))
        target.write_text(page, encoding="utf-8")
