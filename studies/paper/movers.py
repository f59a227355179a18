"""Fig. 8: avoiding movers, with speed and heading around the closest approach."""

from collections.abc import Iterator

import numpy as np

from . import cast
from .encounters import SPEED, TURN, Behaviour, behaviour
from .evidence import Evidence
from .markdown import table
from .pictures import Pictures

DRIVERS = (cast.PAPER, cast.PLUS)


def behaviours(evidence: Evidence) -> dict[str, Behaviour]:
    """Return the behaviour of each learned navigator in `leaders/dynamic`."""
    return {
        navigator: behaviour(evidence.episodes((cast.DYNAMIC, "unknown", navigator)))
        for navigator in DRIVERS
    }


def section(evidence: Evidence, found: dict[str, Behaviour], pictures: Pictures) -> Iterator[str]:
    """Yield the lines of the section."""
    yield "## Fig. 8: movers"
    yield ""
    yield (
        "`leaders/dynamic`, track `unknown`. An *encounter* begins when the collision"
        " probability of"
        " Eq. 22–24 with one mover exceeds T_c = 0.6 (the *alarm*), and ends two seconds after the"
        " closest approach; the *gap* is that to the mover's circumscribed circle;"
        f" changes below {SPEED} m/s in speed, or below {np.degrees(TURN):.0f}° in heading, do not"
        " count."
    )
    yield ""
    rows = []
    for navigator, b in found.items():
        e = b.encounters
        if not e:
            continue
        rows.append([
            f"`{navigator}`", f"{len(e):,}", _share(x.hit for x in e),
            _share(x.sped > SPEED for x in e), _share(x.sped < -SPEED for x in e),
            _share(x.turned > TURN for x in e), f"{np.median([x.gap for x in e]):.2f}",
            f"{b.speed[0]:.2f} / {b.speed[1]:.2f}", f"{b.turning[0]:.2f} / {b.turning[1]:.2f}",
        ])  # fmt: skip
    yield from table(
        ["navigator", "encounters", "hit %", "sped up %", "slowed down %", "turned %",
         "median gap to the circle m", "speed without / with alarm m/s",
         "turn rate without / with alarm rad/s"],
        rows,
    )  # fmt: skip
    pictures.encounters(evidence, found)
    yield (
        "![Left: one encounter; right: speed and change of heading around the closest approach,"
        " median and middle half of all encounters without a hit](images/paper-movers.png)"
    )
    yield ""


def _share(flags: Iterator[bool]) -> str:
    return f"{100 * np.mean(list(flags)):.1f}"
