"""The state of a batch of worlds, as a few arrays of records.

A kernel handles one record (an agent, a body, a capsule) and receives it as a pointer.
Sixty plain arrays as arguments of every call made the step a hundred times slower
and its compilation longer. Outside the kernels, `field` gives plain array views.
"""

from collections.abc import Sequence

import numpy as np

from benchnav.arena.solid import Solid
from benchnav.arrays import AnyArray, IntArray

OPEN_CONTACTS = 8  # of an agent at one time; one more closes the oldest
LISTED = 10  # of the nearest others of an agent that sensing found


def _record(**fields: str) -> np.dtype[np.void]:
    # np.record: an interpreted kernel then accesses fields like a compiled one
    return np.dtype((np.record, np.dtype(list(fields.items()), align=True)))


# one world: its clock, rules, and the location of its part in the flat arrays
WORLD = _record(
    dt="f8", h="f8", tolerance="f8", reach="f8", widest="f8", cells="f8",
    origin_x="f8", origin_y="f8", side="f8",
    substeps="i8", steps="i8", steps_done="i8", revision="i8", contact="i8", nx="i8", ny="i8",
    grid="i8", first="i8", last="i8", agents="i8", bodies="i8", closed="i8",
    waiting="i8",
    vanish_on_arrival="?", vanish_on_end="?", charge_both="?", running="?", limited="?",
    shaped="?",
)  # fmt: skip

# core_length, core_width: half the core's extent along and across the axis (the heading); a disc
# is not `shaped`, its core is a point, and its axis is not used
# (B, A), padding has present = False; fields that others read come first, in one cache line;
# `queued` of record n is the agent that is the n-th to enter
AGENT = _record(
    x="f8", y="f8", vx="f8", vy="f8", radius="f8", ci="i4", cj="i4", team="i4",
    spot="i4", status="i1", present="?", nonholonomic="?", evaluated="?", turning="?", halted="?",
    open="?", shaped="?",
    heading="f8", goal_x="f8", goal_y="f8", arrival="f8", max_speed="f8", max_turn_rate="f8",
    preferred_speed="f8", drive_0="f8", drive_1="f8", tau="f8", code="i8", home="i8", hits="i8",
    core_length="f8", core_width="f8", rounding="f8", inner_radius="f8", axis_x="f8", axis_y="f8",
    enters="f8", queued="i8",
)  # fmt: skip

# (B, A), read in worlds that are `limited`: limits of motion, and the steering angle [rad]
LIMITS = _record(
    max_speed="f8", max_turn_rate="f8", max_acceleration="f8", max_deceleration="f8",
    max_turn_acceleration="f8", half_track="f8", max_wheel_speed="f8", wheelbase="f8",
    max_steering_angle="f8", max_steering_rate="f8", steering="f8", dynamics="i1", reverse="?",
)  # fmt: skip

# an agent in a hashed cell (ci, cj) with its motion, so that a search reads one array in order
SPOT = _record(
    x="f8", y="f8", vx="f8", vy="f8", radius="f8", ci="i4", cj="i4", index="i4", team="i4"
)  # fmt: skip

# (B, M): dynamic obstacles and relocated static obstacles
BODY = _record(
    x="f8", y="f8", vx="f8", vy="f8", next_x="f8", next_y="f8", bound="f8", phase="f8",
    first="i8", last="i8", law_first="i8", law_last="i8",
    law="i1", kind="i1", periodic="?", placed="?",
)  # fmt: skip

# of fixed solids in the world's frame, of bodies in the body's frame; (nx, ny) is the unit
# normal of an edge, out of the solid, and zero for a disc
CAPSULE = _record(
    x0="f8", y0="f8", x1="f8", y1="f8", r="f8", nx="f8", ny="f8",
    solid="i8", before="i8", after="i8", kind="i1",
)  # fmt: skip

# a corner point of a motion law: the position at a time
KNOT = _record(t="f8", x="f8", y="f8")

# an event that is open (B, A, OPEN_CONTACTS; code -1: free) or closed (B, N); (x, y) is the
# agent's position at the first touch
CONTACT = _record(
    code="i8", agent="i8", start="f8", end="f8", penetration="f8", closing="f8", x="f8", y="f8",
    charged="?",
)  # fmt: skip


def field(records: AnyArray, name: str, width: int = 1) -> AnyArray:
    """Return a view of ``width`` adjacent fields of equal type as a last axis (none if 1)."""
    kind, offset = records.dtype.fields[name][:2]  # type: ignore[index]
    if width == 1:
        view: AnyArray = records[name]
        return view
    if records.size == 0:
        return np.zeros((*records.shape, width), kind)
    return np.ndarray(
        (*records.shape, width), kind, records.data, offset, (*records.strides, kind.itemsize)
    )


def capsule_records(solids: Sequence[Solid], number: Sequence[int], shift: int) -> AnyArray:
    """Return CAPSULE records of solids, one after another.

    Args:
        solids: N of them.
        number: of each solid, for the records.
        shift: is added to the indices along the loops.
    """
    if not solids:
        return np.zeros(0, CAPSULE)
    parts = [solid.capsules for solid in solids]
    sizes = [len(part) for part in parts]
    capsules = np.vstack(parts)
    out = np.zeros(len(capsules), CAPSULE)
    for k, name in enumerate(("x0", "y0", "x1", "y1", "r")):
        out[name] = capsules[:, k]
    ex, ey = out["x1"] - out["x0"], out["y1"] - out["y0"]
    length = np.sqrt(ex * ex + ey * ey)
    edge = length > 0.0
    out["nx"][edge], out["ny"][edge] = ey[edge] / length[edge], -ex[edge] / length[edge]
    out["before"], out["after"] = _chain(solids, shift)
    out["solid"] = np.repeat(number, sizes)
    out["kind"] = np.repeat([int(solid.kind) for solid in solids], sizes)
    return out


def _chain(solids: Sequence[Solid], shift: int) -> tuple[IntArray, IntArray]:
    """Return the previous and next capsule (P,), (P,) in each capsule's loop; -1 for a disc."""
    loops = [len(loop) for solid in solids for loop in solid.loops or ((),)]  # a disc has no length
    ends = np.cumsum(np.maximum(loops, 1))
    index = np.arange(ends[-1]) + shift
    before, after = index - 1, index + 1
    last = ends - 1
    first = np.concatenate([[0], ends[:-1]])
    disc = np.array(loops) == 0
    before[first], after[last] = np.where(disc, -1, last + shift), np.where(disc, -1, first + shift)
    return before, after
