"""`benchnav watch`: run a navigator in one world, and show it."""

from pathlib import Path
from typing import Annotated

import typer

from benchnav.cli.console import put, say
from benchnav.text.file_name import file_name


def watch(
    scenario: Annotated[
        str,
        typer.Argument(
            metavar="SCENARIO", help="A name, with parameters as NAME:key=value, or a file."
        ),
    ],
    navigators: Annotated[
        list[str],
        typer.Argument(metavar="NAVIGATOR…", help="Names; several are shown side by side."),
    ],
    seed: Annotated[int, typer.Option(help="Of the world.")] = 0,
    track: Annotated[str, typer.Option(help="known, stale, partial or unknown.")] = "known",
    perception: Annotated[str, typer.Option(help="exact or noisy.")] = "exact",
    out: Annotated[
        Path | None,
        typer.Option(
            help="A page (.html), a moving picture (.gif, .mp4), a figure (.png, .svg, .pdf), or a"
            " recording for Rerun (.rrd) or Foxglove (.mcap)."
            " [default: watch-….html in this folder]"
        ),
    ] = None,
    show: Annotated[
        bool, typer.Option("--open/--no-open", help="Open the page if there is a display.")
    ] = True,
) -> None:
    """Run navigators in one world, and write a page that plays the episodes.

    No run is stored.
    """
    from benchnav.api.execution.simulate import simulate
    from benchnav.api.records.replay import Replay, open_in_browser
    from benchnav.api.records.scenario import load_scenario

    world = load_scenario(scenario).world(seed=seed)
    episodes = [
        simulate(world, navigator, track=track, perception=perception) for navigator in navigators
    ]
    for episode in episodes:
        say(f"{episode!r}")
    path = out or Path(file_name("watch", *navigators, scenario, str(seed), suffix=".html"))
    Replay.of(episodes).save(path)
    put(str(path))
    if show and not open_in_browser(path):
        say("There is no display here: open the file above in a browser.")
