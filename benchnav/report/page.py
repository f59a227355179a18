"""A page of a report, and links between pages."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from os.path import relpath
from pathlib import PurePosixPath
from typing import TYPE_CHECKING

from benchnav.scenario.condition import EXACT, episode_name
from benchnav.text.file_name import file_name

if TYPE_CHECKING:
    from markupsafe import Markup

LEADERBOARD = PurePosixPath("index.html")
SCENARIOS = PurePosixPath("scenarios.html")
NAVIGATORS = PurePosixPath("navigators.html")
COMPARISON = PurePosixPath("comparison.html")
FAILURES = PurePosixPath("failures.html")
ABOUT = PurePosixPath("about.html")
ASSETS = PurePosixPath("assets")

_SHORT = 8  # hexadecimal digits that keep the names of two files apart


@dataclass(frozen=True)
class Page:
    """A page. Its body is HTML in which all text is escaped (`benchnav.report.template`)."""

    path: PurePosixPath  # within the report folder
    title: str  # plain text
    body: Markup
    entry: PurePosixPath  # the entry of the navigation bar that is marked as current
    has_figures: bool = False  # loads plotly
    has_tables: bool = False  # loads the table library


def scenario_path(scenario: str) -> PurePosixPath:
    """Return the path of a scenario's page; ``scenario`` is its identity, ``trap/u@1``."""
    return PurePosixPath("scenarios", _file(scenario))


def navigator_path(navigator: str) -> PurePosixPath:
    """Return the path of a navigator's page."""
    return PurePosixPath("navigators", _file(navigator))


def replay_path(
    navigator: str, scenario: str, track: str, seed: int, perception: str = EXACT
) -> PurePosixPath:
    """Return the path of a replay."""
    name = episode_name(navigator, scenario, track, perception, seed)
    return PurePosixPath("replays", _file(name))


def href(page: PurePosixPath, target: PurePosixPath) -> str:
    """Return the relative link from a page to another file of the report."""
    return PurePosixPath(relpath(target, page.parent)).as_posix()


def _file(name: str) -> str:
    """Return a file name that every system allows and that no other name has."""
    digest = hashlib.sha256(name.encode("utf-8", "replace")).hexdigest()[:_SHORT]
    plain = "".join(c if c.isascii() else "-" for c in name)[:60]
    return file_name(plain, digest, suffix=".html")


@dataclass(frozen=True)
class Site:
    """The title, navigation and footer of all pages of a report."""

    title: str
    entries: tuple[tuple[str, PurePosixPath], ...]  # the navigation bar: text, page
    footer: str


def render(page: Page, site: Site) -> str:
    """Return the HTML file of a page. Raises MissingExtraError if Jinja2 is not installed."""
    from benchnav.report.template import fill

    def asset(name: str) -> str:
        return href(page.path, ASSETS / name)

    return str(fill("page.html", page=page, site=site, asset=asset, about=ABOUT))
