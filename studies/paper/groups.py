"""Figs. 11 and 12 against 13: a guided crowd, and navmesh + RVO, in the same worlds."""

from collections.abc import Iterator

from . import cast
from .evidence import Evidence
from .markdown import table
from .pictures import Pictures

METRICS = (  # name, what the table calls it, scale, decimals, role
    ("success", "success of followers %", 100, 1, "follower"),
    ("success", "success of leaders %", 100, 1, "leader"),
    ("arrival", "arrival of followers %", 100, 1, "follower"),
    ("collisions_agent", "collisions with agents per follower", 1, 2, "follower"),
    ("collisions_static", "with static obstacles", 1, 2, "follower"),
    ("collisions_dynamic", "with movers", 1, 2, "follower"),
    ("density_mean", "mean density at the centre 1/m²", 1, 3, "follower"),
    ("density_peak", "greatest density there 1/m²", 1, 2, "follower"),
    ("jam", "time in a jam %", 100, 1, "follower"),
    ("cohesion", "cohesion (1: packed)", 1, 2, "follower"),
    ("splits", "parts of a group", 1, 2, "follower"),
    ("polarisation", "polarisation", 1, 3, "follower"),
    ("path_keeping", "distance from the leader's way m", 1, 2, "follower"),
    ("makespan", "makespan s", 1, 1, "follower"),
)
CAST = (cast.GUIDED, cast.GUIDED_PLUS, cast.BOTH, cast.LOCAL)


def cell(navigator: str) -> tuple[str, str, str]:
    """Return the cell of a navigator in the scenario of groups."""
    return cast.GROUPS, "known", navigator


def section(evidence: Evidence, pictures: Pictures) -> Iterator[str]:
    """Yield the lines of the section."""
    yield "## Figs. 11 and 12 against 13: guided groups, and navmesh + RVO"
    yield ""
    yield (
        "`groups/diagonal`: four groups of 25 cross through the middle, where cubes stand and move."
        f" `{cast.GUIDED}` rehearses its leaders five times (Fig. 11) and lets each group follow"
        " the"
        f" best trajectory with ORCA (Fig. 12); `{cast.BOTH}` is Fig. 13, `{cast.LOCAL}` heads"
        " straight"
        " for the goals. Values are means over worlds; the difference is paired by world, its"
        f" interval in bold where it leaves out zero: `{cast.GUIDED}` − `{cast.BOTH}`. Guidance"
        " costs"
        " rehearsals, which the leaderboard charges and never ranks with entries that had none."
    )
    yield ""
    rows = []
    for metric, heading, scale, digits, role in METRICS:
        change = evidence.difference(metric, cell(cast.GUIDED), cell(cast.BOTH), role)
        text = change.text(scale, digits)
        rows.append([
            heading,
            *(evidence.value(metric, cell(label), role).text(scale, digits) for label in CAST),
            f"**{text}**" if change.sure else text,
        ])  # fmt: skip
    head = ["", *(f"`{navigator}`" for navigator in CAST), "difference"]
    yield from table(head, rows)
    pictures.groups(evidence)
    yield (
        "![The same world: leaders' rehearsals (Fig. 11), then the guided crowd (Fig. 12) and"
        " navmesh"
        " + RVO (Fig. 13) at four times](images/paper-groups.png)"
    )
    yield ""
