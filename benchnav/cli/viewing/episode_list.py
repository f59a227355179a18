"""The table of `benchnav replay --list`."""

from typing import TYPE_CHECKING

from benchnav.cli.console import put, say

if TYPE_CHECKING:
    from benchnav.api.records.episodes import Episodes
    from benchnav.api.records.run import Run

_LISTED = 200  # lines at most
_HEAD = ("episode", "success", "duration", "cause")


def print_list(run: "Run", found: "Episodes") -> None:
    """Print the names of episodes, the shares of successful agents, durations, and causes."""
    from benchnav.api.records.episode_results import episode_results

    places = found.places[:_LISTED]
    rows = [_HEAD]
    for place, result in zip(places, episode_results(run.folder, places), strict=True):
        success, causes = f"{100 * result.success:.0f} %", ", ".join(result.causes)
        rows.append((place.name, success, f"{result.duration:.1f} s", causes))
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for row in rows:
        line = f"{row[0]:<{widths[0]}}  {row[1]:>{widths[1]}}  {row[2]:>{widths[2]}}  {row[3]}"
        put(line.rstrip())
    if len(found) > len(places):
        left = len(found) - len(places)
        say(f"{left} more: name a navigator, scenario, track, perception or seed.")
