"""The table of measured values: one row per episode, role and metric.

It is computed from the stored episodes and can be recomputed at any time; it
is stored with them so that a leaderboard needs no second pass.
"""

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from benchnav.arena.agents import Role
from benchnav.arrays import LARGEST
from benchnav.config.document import shown
from benchnav.scenario.condition import EXACT
from benchnav.scenario.terms import PERCEPTIONS, SPLITS, TRACKS
from benchnav.store.runs.spans import SEED_END

MAX_ROWS = 1 << 18  # of a part: 64 seeds, two roles and 2048 metrics
_MOST_AGENTS = 1_000_000
_KEYS = ("seed", "role", "metric")  # a part has one row per combination
_TEXTS = {  # column → allowed number of characters
    "navigator": 200, "scenario": 2_000, "scenario_hash": 64, "metric": 200, "failure": 10_000,
    "navigator_hash": 64, "missing": 10_000, "source_hash": 64, "traceback": 10_000,
    "remarks": 10_000,
}  # fmt: skip
_ONE_OF = {
    "track": TRACKS, "perception": PERCEPTIONS, "split": SPLITS,
    "role": tuple(r.name.lower() for r in Role),
}  # fmt: skip
_RANGES: dict[str, tuple[float, float]] = {
    "seed": (0, SEED_END), "value": (-LARGEST, LARGEST), "agents": (1, _MOST_AGENTS),
    "defined": (0, _MOST_AGENTS), "horizon": (0, 1e6), "dt": (0, 10), "rehearsal": (0, 1_000_000),
    "rehearsal_decisions": (0, 1 << 60), "rehearsal_seconds": (0, LARGEST),
}  # fmt: skip
_MAY_BE_NULL = ("source_hash", "traceback", "remarks")

RESULTS = pa.schema(
    [
        ("navigator", pa.string()),  # the label
        ("scenario", pa.string()),  # "leaders/dynamic@1"
        ("scenario_hash", pa.string()),
        ("track", pa.string()),
        ("split", pa.string()),
        ("seed", pa.int64()),
        ("role", pa.string()),  # leader, follower
        ("metric", pa.string()),
        (
            "value",
            pa.float64(),
        ),  # mean over the agents of the role where defined; NaN if nowhere defined
        ("agents", pa.int64()),  # agents of the role
        ("defined", pa.int64()),  # agents over which the mean is taken
        ("failure", pa.string()),  # why the navigator failed in this episode; "" if it did not
        ("horizon", pa.float64()),  # [s]
        ("dt", pa.float64()),  # [s]
        ("navigator_hash", pa.string()),  # of configuration, distributions, mode; "" in older parts
        ("rehearsal", pa.int64()),  # rehearsals granted; 0 in older parts, like the next two
        ("rehearsal_decisions", pa.int64()),  # of agents, in the rehearsals of this world
        ("rehearsal_seconds", pa.float64()),  # of the leading navigator
        ("missing", pa.string()),  # how the metric failed; "" if it did not, and in older parts
        ("source_hash", pa.string()),  # of the navigator's code and data; "" if unknown
        ("traceback", pa.string()),  # of the failure; null if none, and in older parts
        ("remarks", pa.list_(pa.string())),  # of the navigator on this episode; null likewise
        ("perception", pa.string()),  # parts of exact perception are stored without this column
    ]
)


LATER = {
    "navigator_hash": "",
    "rehearsal": 0,
    "rehearsal_decisions": 0,
    "rehearsal_seconds": 0.0,
    "missing": "",
    "source_hash": "",
    "traceback": None,
    "remarks": None,
    "perception": EXACT,
}
"""Columns that older parts do not have, and their default values."""


def stored_form(table: pa.Table) -> pa.Table:
    """Return a table of `RESULTS` as it is stored: only noisy perception has a column."""
    exact = pc.all(pc.equal(table["perception"], EXACT)).as_py() is not False
    return table.drop_columns("perception") if exact else table


def completed(table: pa.Table) -> pa.Table:
    """Return an encoded table with the columns that older parts do not have."""
    for name, missing in LATER.items():
        if name not in table.column_names:
            kind = RESULTS.field(name).type
            column = pa.repeat(pa.scalar(missing, kind), len(table))
            encoded = column.dictionary_encode() if pa.types.is_string(kind) else column
            table = table.append_column(name, encoded)
    return table.select(RESULTS.names)


def require_possible(table: pa.Table) -> None:
    """Raise ValueError if an encoded table of `RESULTS` holds values that no part can have."""
    if len(table) > MAX_ROWS:
        raise ValueError(f"must have at most {MAX_ROWS} rows; it has {len(table)}")
    for name in RESULTS.names:
        column = table[name]
        if name not in _MAY_BE_NULL and column.null_count:
            raise ValueError(f"must have a value in each row of {name!r}; one is null")
        if name in _RANGES:
            _require_range(name, column)
        elif name in _ONE_OF:
            _require_one_of(name, column)
        else:
            _require_short(name, column)
    if pc.any(pc.greater(table["defined"], table["agents"])).as_py():
        raise ValueError("must not have more 'defined' than 'agents'")
    keys = [pc.dictionary_encode(table[name].combine_chunks()) for name in _KEYS]
    places = np.column_stack([key.indices.to_numpy() for key in keys])
    if len(np.unique(places @ [1 << 42, 1 << 21, 1])) < len(table):
        raise ValueError(f"must have one row for each {', '.join(_KEYS)}; it has more")


def _require_range(name: str, column: pa.ChunkedArray) -> None:
    low, high = _RANGES[name]
    found = pc.min_max(column).as_py()  # None without numbers; only a value may be NaN
    numbers = [x for x in found.values() if x is not None and (x == x or name != "value")]
    strange = [x for x in numbers if not low <= x <= high]
    if pa.types.is_floating(column.type) and name != "value" and pc.any(pc.is_nan(column)).as_py():
        strange.append(float("nan"))
    if strange:
        raise ValueError(f"must have {name!r} from {low:g} to {high:g}; it has {strange[0]!r}")


def _require_one_of(name: str, column: pa.ChunkedArray) -> None:
    for value in column.unique().to_pylist():
        if value not in _ONE_OF[name]:
            known = ", ".join(_ONE_OF[name])
            raise ValueError(f"must have {name!r} out of {known}; it has {shown(value)!r}")


def _require_short(name: str, column: pa.ChunkedArray) -> None:
    most = _TEXTS[name]
    texts = pc.list_flatten(column) if pa.types.is_list(column.type) else _distinct(column)
    longest = pc.max(pc.utf8_length(texts)).as_py() or 0
    if longest > most:
        raise ValueError(f"must have at most {most} characters in {name!r}; one has {longest}")


def _distinct(column: pa.ChunkedArray) -> pa.Array:
    found = column.unique()
    return found.dictionary_decode() if pa.types.is_dictionary(found.type) else found
