"""The table of measured values: one row per episode, role and metric.

It is computed from the stored episodes and can be computed again at any time; it
is kept beside them so that a leaderboard needs no second pass.
"""

import pyarrow as pa

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
        ),  # mean over the agents of the role where defined; NaN where nowhere
        ("agents", pa.int64()),  # agents of the role
        ("defined", pa.int64()),  # agents over which the mean was taken
        ("failure", pa.string()),  # why the navigator failed in this episode; "" if it did not
        ("horizon", pa.float64()),  # [s]
        ("dt", pa.float64()),  # [s]
        ("navigator_hash", pa.string()),  # of configuration, distributions, mode; "" in older
        ("rehearsal", pa.int64()),  # rehearsals granted; 0 in older parts, as the next two
        ("rehearsal_decisions", pa.int64()),  # of agents, in the rehearsals of this world
        ("rehearsal_seconds", pa.float64()),  # of the navigator that led
        ("missing", pa.string()),  # how the metric failed; "" where it did not, and in older parts
        ("source_hash", pa.string()),  # of the navigator's code and data; "" where not known
        ("traceback", pa.string()),  # of that; null where nothing was raised, and in older parts
        ("remarks", pa.list_(pa.string())),  # of the navigator on this episode; null likewise
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
}
"""Columns that older parts lack, and what stands for them."""


def completed(table: pa.Table) -> pa.Table:
    """The table with what older parts lack."""
    for name, missing in LATER.items():
        if name not in table.column_names:
            field = RESULTS.field(name)
            table = table.append_column(
                field, pa.repeat(pa.scalar(missing, field.type), len(table))
            )
    return table.select(RESULTS.names)
