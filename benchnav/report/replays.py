"""The replay pages of a report."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from benchnav.episode.episode import Episode
from benchnav.report.failed_episodes import Cell
from benchnav.report.page import ASSETS, FAILURES, href, replay_path
from benchnav.viewer.replay.page import replay_page
from benchnav.viewer.replay.scene import interesting, scene


@dataclass(frozen=True)
class ReplayPlan:
    """The episodes that get a replay, and the folder of the report."""

    seeds: Mapping[Cell, int]
    folder: Path


def write_replay(episode: Episode, folder: Path) -> None:
    """Write the replay of an episode into the folder of a report."""
    identity = episode.identity
    path = replay_path(
        identity.navigator, identity.scenario, identity.track, identity.seed, identity.perception
    )
    target = folder / path
    target.parent.mkdir(exist_ok=True)
    back = href(path, FAILURES)
    page = replay_page([scene(episode, interesting(episode))], href(path, ASSETS), back)
    target.write_text(page, encoding="utf-8")
