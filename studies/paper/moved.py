"""Fig. 6: success before and after the static obstacles move."""

from collections.abc import Iterator

from . import cast
from .evidence import Evidence
from .markdown import table

ROWS = (  # navigator, and its tracks after the move
    (cast.PAPER, ("unknown",)),
    (cast.PLUS, ("unknown",)),
    (cast.HYBRID, ("unknown",)),
    (cast.TABULAR, ("unknown",)),
    (cast.PLANNER, ("stale", "known")),
    (cast.BOTH, ("stale", "known")),
    (cast.GRID, ("stale", "known")),
)
MAPS = {"unknown": "no map", "stale": "the map of before", "known": "a new map"}


def section(evidence: Evidence) -> Iterator[str]:
    """Yield the lines of the section."""
    yield "## Fig. 6: the static obstacles move"
    yield ""
    yield (
        "Success per agent in %. *Before* is `leaders/static`; *after* is `leaders/moved`, where"
        " the cubes were re-placed before the episode. No navigator was trained again. The worlds"
        " of the two scenarios are not the same, so that their difference is not paired world by"
        " world."
    )
    yield ""
    rows = []
    for navigator, tracks in ROWS:
        for track in tracks:
            before = (cast.STATIC, "known" if track != "unknown" else "unknown", navigator)
            after = (cast.MOVED, track, navigator)
            change = evidence.difference("success", after, before)
            rows.append([
                f"`{navigator}`", MAPS[track], evidence.value("success", before).text(100),
                evidence.value("success", after).text(100), change.text(100),
            ])  # fmt: skip
    yield from table(["navigator", "after the move it has", "before", "after", "change"], rows)
    yield (
        "In `leaders/moving-furniture` three cubes are re-placed once while the agents are on their"
        " way; the map of track `known` follows them at once."
    )
    yield ""
    plans = [(cast.ONCE, "known"), (cast.PLANNER, "known"), (cast.MAPPER, "unknown"),
             (cast.BOTH, "known"), (cast.PAPER, "unknown"), (cast.PLUS, "unknown")]  # fmt: skip
    yield from table(
        ["navigator", "track", "success %", "hits of static obstacles per 100 agents"],
        [
            [f"`{label}`", track,
             evidence.value("success", (cast.FURNITURE, track, label)).text(100),
             evidence.value("collisions_static", (cast.FURNITURE, track, label)).text(100)]
            for label, track in plans
        ],
    )  # fmt: skip
