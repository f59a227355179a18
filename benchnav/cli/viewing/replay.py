"""`benchnav replay`: watch stored episodes."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from benchnav.cli.console import put, say
from benchnav.cli.viewing.episode_filter import EpisodeFilter
from benchnav.cli.viewing.episode_list import print_list
from benchnav.text.file_name import file_name

if TYPE_CHECKING:
    from benchnav.api.records.episodes import Place


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
    perception: Annotated[
        str | None, typer.Option(help="With this perception: exact or noisy.")
    ] = None,
    seed: Annotated[int | None, typer.Option(help="In the world of this seed.")] = None,
    failed: Annotated[
        bool, typer.Option("--failed", help="Only where an agent did not succeed.")
    ] = False,
    cause: Annotated[
        str | None,
        typer.Option(
            help="Only where an agent did not succeed for this cause: collided, timeout, stuck or"
            " failed (the navigator)."
        ),
    ] = None,
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
        bool, typer.Option("--list", help="List the episodes and how they ended; write nothing.")
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
    from benchnav.api.records.episode_names import named_episodes
    from benchnav.api.records.replay import open_in_browser
    from benchnav.api.records.run import open_run

    wanted = EpisodeFilter(
        navigators=tuple(navigator or ()), scenario=scenario, track=track,
        perception=perception, seed=seed, failed=failed if cause is None else cause, worst=worst,
    )  # fmt: skip
    if episodes:
        wanted.require_unused(episodes, lists=list_)
    with open_run(run) as opened:
        if list_:
            found = wanted.all_of(opened)
            print_list(opened, found) if found else put(wanted.why_none(opened))
            return
        chosen = named_episodes(opened, episodes) if episodes else wanted.first_of(opened)
        page = chosen.replay(agent)
        path = page.save(out or Path(_file_name(chosen.places)), time or ())
    say(f"{page!r}")
    put(str(path))
    if show and not open_in_browser(path):
        say("No browser could be opened here: open the file above in one.")


def _file_name(places: "tuple[Place, ...]") -> str:
    """Return the default name of the page."""
    from benchnav.scenario.condition import condition

    first = places[0]
    names = dict.fromkeys(place.navigator for place in places)
    scenario = first.scenario.split("@")[0]
    where = condition(first.track, first.perception)
    return file_name("replay", *names, scenario, where, str(first.seed), suffix=".html")
