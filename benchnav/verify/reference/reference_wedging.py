"""Touches of wedged agents in the reference simulator.

A wedged agent stands still until the substep ends. A body that reaches it meanwhile changes
nothing, but the touch is recorded.
"""

from typing import TYPE_CHECKING

import numpy as np

from benchnav.verify.reference.reference_contacts import MAX_HITS, MAX_OPEN
from benchnav.verify.reference.reference_geometry import unit

if TYPE_CHECKING:
    from benchnav.verify.reference.reference_simulator import Twin


def record_wedged(twin: "Twin", now: float, left: float) -> None:
    """Record the bodies that touch wedged agents within the next ``left`` [s]."""
    agents = np.flatnonzero(twin.active & (twin.hits >= MAX_HITS))
    if not len(agents):
        return
    times = twin.touch_times(agents)[2]
    for i, row in zip(agents, times, strict=True):
        for m in range(len(twin.bodies)):
            t = float(row[twin.owner == m].min())
            if t <= left and sum(key[0] == i for key in twin.ledger.opened) < MAX_OPEN:
                _record(twin, int(i), m, now, t)


def _record(twin: "Twin", i: int, m: int, now: float, t: float) -> None:
    """Record that body m touches agent i after ``t`` [s]."""
    here = twin.bodies
    twin.bodies = here + twin.carry * t
    away, velocity = twin.away(i, "body", m, -1)
    twin.bodies = here
    twin.ledger.record(i, ("body", m), now + t, float(velocity @ unit(away)), True)
