"""`benchnav replay`: watch stored episodes."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from benchnav.cli.console import put, say
from benchnav.errors import UsageError
from benchnav.text.file_name import file_name

if TYPE_CHECKING:
    from benchnav.api.records.episodes import Episodes, Place
    from benchnav.api.records.run import Run

_LISTED = 200  # lines of --list at most
_PARTS = ("navigator", "scenario", "track", "seed")


def replay(
    run: Annotated[Path, typer.Argument(metavar="RUN", help="A run folder or a pack.")],
    episodes: Annotated[
        list[str] | None,
        typer.Argument(metavar="[EPISODE]…", help="Episodes as --list prints them."),
    ] = None,
    navigator: Annotated[
        list[str] | None,
        typer.Option(help="Of this navigator. Repeated: side by side in one world."),
    ] = None,
    scenario: Annotated[str | None, typer.Option(help="In this scenario.")] = None,
    track: Annotated[str | None, typer.Option(help="On this track.")] = None,
    seed: Annotated[int | None, typer.Option(help="In the world of this seed.")] = None,
    failed: Annotated[
        bool, typer.Option("--failed", help="Only where an agent did not succeed.")
    ] = False,
    worst: Annotated[
        str | None, typer.Option(metavar="METRIC", help="The one that is worst by this metric.")
    ] = None,
    agent: Annotated[
        list[int] | None,
        typer.Option(
            help="With the sensor readings and charts of this agent. Repeatable."
            " [default: four agents, first those that did not succeed]"
        ),
    ] = None,
    list_: Annotated[
        bool, typer.Option("--list", help="List the episodes, and write nothing.")
    ] = False,
    out: Annotated[
        Path | None,
        typer.Option(
            help="A page (.html), a moving picture (.gif, .mp4), a figure (.png, .svg, .pdf), or a"
            " recording for Rerun (.rrd) or Foxglove (.mcap)."
            " [default: replay-….html in this folder]"
        ),
    ] = None,
    time: Annotated[
        list[float] | None,
        typer.Option(help="[s] A figure shows this time. Repeatable. [default: trails]"),
    ] = None,
    show: Annotated[bool, typer.Option("--open", help="Open the file.")] = False,
) -> None:
    """Write a page that plays stored episodes. It opens from disk without a network.

    Without options it shows the first episode in which an agent did not succeed, or the first one.
    """
    from benchnav.api.records.replay import open_in_browser
    from benchnav.api.records.run import open_run

    navigators = navigator or []
    with open_run(run) as opened:
        one = navigators[0] if navigators else None
        found = opened.episodes(one, scenario, track, seed, failed=failed, worst=worst)
        if list_:
            _print_list(found)
            return
        if episodes:
            chosen = _named(opened, episodes)
        else:
            is_unnamed = not (failed or worst or seed is not None)
            chosen = _first(opened, found, navigators, failed_first=is_unnamed)
        page = chosen.replay(agent)
        path = page.save(out or Path(_file_name(chosen.places)), time or ())
    say(f"{page!r}")
    put(str(path))
    if show and not open_in_browser(path):
        say("No browser could be opened here: open the file above in one.")


def _first(
    run: "Run", found: "Episodes", navigators: list[str], *, failed_first: bool
) -> "Episodes":
    """Return the first episode found, and those of the other navigators in the same world."""
    from benchnav.api.records.episode_choice import failed_episodes, in_same_world

    if not len(found):
        raise UsageError(
            f"No stored episode of {run.path} is like that."
            f" 'benchnav replay {run.path} --list' shows all."
        )
    if failed_first:
        found = failed_episodes(run.folder, found.places, run)[:1] or found
    if len(navigators) > 1:
        return in_same_world(run.folder, found.places[0], navigators, run)
    return found[:1]


def _named(run: "Run", names: list[str]) -> "Episodes":
    """Return the episodes that are named as in the list."""
    from benchnav.api.records.episodes import Episodes

    places = []
    for name in names:
        parts = name.rsplit("/", 2) if name.count("/") >= 3 else []
        if not parts or not parts[2].isdigit():
            raise UsageError(
                f"An episode must be named NAVIGATOR/SCENARIO/TRACK/SEED. Got {name!r} instead;"
                f" 'benchnav replay {run.path} --list' shows all."
            )
        there = next(
            (
                found
                for found in run.episodes(track=parts[1], seed=int(parts[2])).places
                if episode_name(found) == name
            ),
            None,
        )
        if there is None:
            raise UsageError(
                f"There is no stored episode {name!r}."
                f" 'benchnav replay {run.path} --list' shows all."
            )
        places.append(there)
    return Episodes(places, run)


def episode_name(place: "Place") -> str:
    """Return NAVIGATOR/SCENARIO/TRACK/SEED."""
    return "/".join(str(getattr(place, part)) for part in _PARTS)


def _print_list(found: "Episodes") -> None:
    names = [episode_name(place) for place in found.places[:_LISTED]]
    put("\n".join(names) if names else "No stored episode is like that.")
    if len(found) > len(names):
        say(f"{len(found) - len(names)} more: name a navigator, scenario, track or seed.")


def _file_name(places: "tuple[Place, ...]") -> str:
    """Return the default name of the page."""
    first = places[0]
    names = dict.fromkeys(place.navigator for place in places)
    scenario = first.scenario.split("@")[0]
    return file_name("replay", *names, scenario, first.track, str(first.seed), suffix=".html")
