"""Episodes ↔ rows of a table: one row per episode, arrays flattened in C order.

A column of states holds the numbers of all agents and times of one episode; its
shape follows from ``steps`` T, ``agents`` A and ``bodies`` M by `SHAPES`. Rows with ``coded``
hold some states as their difference from a prediction, see `state_codec`.
"""

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import pyarrow as pa

from benchnav.arena.world import World
from benchnav.arrays import AnyArray, BoolArray
from benchnav.episode.episode import Contacts, Episode, Identity, Timings
from benchnav.scenario.condition import EXACT
from benchnav.store.parts import state_codec
from benchnav.store.parts.world_codec import world_from_json, world_to_json

SHAPES = {  # column → its shape in T, A, M
    "position": "T+1 A 2",
    "heading": "T+1 A",
    "status": "T+1 A",
    "requested": "T A 2",
    "executed": "T A 2",
    "body_position": "T+1 M 2",
    "arrival": "A",
}
_AXES = {name: shape.split() for name, shape in SHAPES.items()}
_IDENTITY = ("scenario", "scenario_hash", "split", "track", "navigator")
_CONTACTS = {
    "agent": pa.int64(), "kind": pa.int8(), "partner": pa.int64(), "start": pa.float64(),
    "end": pa.float64(), "penetration": pa.float64(), "closing_speed": pa.float64(),
    "charged": pa.bool_(),
}  # fmt: skip
_NUMPY = {pa.float64(): np.float64, pa.int64(): np.int64, pa.int8(): np.int8, pa.bool_(): np.bool_}


def _item(column: str) -> pa.DataType:
    return pa.int8() if column == "status" else pa.float64()


EPISODES = pa.schema(
    [
        *((name, pa.string()) for name in _IDENTITY),
        ("seed", pa.int64()),
        ("failure", pa.string()),
        ("reproducible", pa.bool_()),
        ("digest", pa.string()),
        ("steps", pa.int64()),
        ("agents", pa.int64()),
        ("bodies", pa.int64()),
        ("world", pa.large_string()),
        *((name, pa.large_list(_item(name))) for name in SHAPES),
        *((f"contact_{name}", pa.large_list(kind)) for name, kind in _CONTACTS.items()),
        ("decision_seconds", pa.large_list(pa.float64())),
        ("planning_seconds", pa.float64()),
        ("batch", pa.int64()),
        ("latency_seconds", pa.large_list(pa.float64())),  # null if not measured
        ("memory_bytes", pa.int64()),  # null if unknown
        ("navigator_hash", pa.string()),
        ("rehearsal", pa.int64()),  # number of the rehearsal; 0: the scored episode
        ("rehearsals", pa.int64()),  # granted before the episode
        ("rehearsal_decisions", pa.int64()),
        ("rehearsal_seconds", pa.float64()),
        ("remarks", pa.list_(pa.string())),
        ("twist", pa.large_list(pa.bool_())),  # of every agent; null: unknown
        ("source_hash", pa.string()),  # of the navigator's code and data; null: unknown
        ("traceback", pa.string()),  # of the failure; null if no exception was raised
        ("coded", pa.bool_()),  # whether states are coded; null: they are not
        ("perception", pa.string()),  # files of exact perception do not have this column
    ]
)
LATER = (
    "latency_seconds",
    "memory_bytes",
    "navigator_hash",
    "rehearsal",
    "rehearsals",
    "rehearsal_decisions",
    "rehearsal_seconds",
    "remarks",
    "twist",
    "source_hash",
    "traceback",
    "coded",
    "perception",
)  # columns that older parts do not have; null there
DICTIONARY = [*_IDENTITY, "navigator_hash", "source_hash", "failure"]  # with repeated values
EXACT_EPISODES = pa.schema([field for field in EPISODES if field.name != "perception"])
"""The columns of a file of exact perception, which older versions can read."""


def to_table(episodes: Sequence[Episode]) -> pa.Table:
    """Return a table (N rows) of `EPISODES`, or of `EXACT_EPISODES` for exact perception."""
    columns: dict[str, Any] = {
        name: [getattr(e.identity, name) for e in episodes]
        for name in (*_IDENTITY, "seed", "navigator_hash", "rehearsal")
    }
    columns["perception"] = [e.identity.perception for e in episodes]
    columns["source_hash"] = [e.identity.source_hash or None for e in episodes]
    for name in ("failure", "reproducible", "digest", "rehearsals", "rehearsal_decisions"):
        columns[name] = [getattr(e, name) for e in episodes]
    columns["steps"] = [len(e.requested) for e in episodes]
    columns["agents"] = [len(e.world.agents) for e in episodes]
    columns["bodies"] = [len(e.world.bodies) for e in episodes]
    columns["world"] = [world_to_json(e.world) for e in episodes]
    columns["coded"] = [state_codec.can_code(e.world) for e in episodes]
    states = [_stored_states(e) for e in episodes]
    for name in SHAPES:
        columns[name] = _lists([arrays[name] for arrays in states], _item(name))
    for name, kind in _CONTACTS.items():
        columns[f"contact_{name}"] = _lists([getattr(e.contacts, name) for e in episodes], kind)
    columns["decision_seconds"] = _lists([e.timings.decision for e in episodes], pa.float64())
    columns["planning_seconds"] = [e.timings.planning for e in episodes]
    columns["batch"] = [e.timings.batch for e in episodes]
    columns["latency_seconds"] = [e.timings.latency for e in episodes]
    columns["memory_bytes"] = [e.timings.memory for e in episodes]
    columns["remarks"] = [list(e.remarks) for e in episodes]
    columns["twist"] = [e.twist for e in episodes]
    columns["traceback"] = [e.traceback or None for e in episodes]
    columns["rehearsal_seconds"] = [e.timings.rehearsal for e in episodes]
    schema = EXACT_EPISODES if set(columns["perception"]) <= {EXACT} else EPISODES
    arrays = [
        values if isinstance(values, pa.Array) else pa.array(values, type=field.type)
        for field in schema
        for values in [columns[field.name]]
    ]
    return pa.Table.from_arrays(arrays, schema=schema)


def _stored_states(episode: Episode) -> dict[str, AnyArray]:
    """Return the arrays of `SHAPES` as they are stored."""
    states = {name: getattr(episode, name) for name in SHAPES}
    if state_codec.can_code(episode.world):
        states |= state_codec.coded(episode.world, _twist(episode.twist, episode.world), states)
    return states


def _twist(twist: BoolArray | None, world: World) -> BoolArray:
    return np.zeros(len(world.agents), np.bool_) if twist is None else twist


def from_table(table: pa.Table, order: Sequence[int] | None = None) -> Iterator[Episode]:
    """Yield the episodes of a table of `EPISODES`; columns of `LATER` may be missing.

    ``order`` gives row numbers. Episodes are created one at a time, so that no second table exists.
    """
    for name in LATER:
        if name not in table.column_names:
            field = EPISODES.field(name)
            table = table.append_column(field, pa.nulls(len(table), field.type))
    for field in EPISODES:
        if field.name not in LATER and table.column(field.name).null_count:
            raise ValueError(f"{field.name} must have a value in every row")
    batches = [_Columns(batch) for batch in table.to_batches()]
    rows = [(batch, row) for batch in batches for row in range(batch.rows)]
    for place in range(len(rows)) if order is None else order:
        yield _episode(*rows[place])


class _Columns:
    """The columns of a record batch: scalars as lists, lists as their numbers and offsets.

    Access to a single cell of a record batch takes longer than the rest of an episode.
    """

    def __init__(self, batch: pa.RecordBatch) -> None:
        self.rows = batch.num_rows
        self.worlds = batch.column("world")  # texts, which are large
        self._scalars: dict[str, list[Any]] = {}
        self._lists: dict[str, tuple[list[int], AnyArray]] = {}
        for name in EPISODES.names:
            column = batch.column(name)
            if isinstance(column, pa.LargeListArray) and name not in LATER:
                numbers = column.values.to_numpy(zero_copy_only=False)
                numbers = numbers.astype(_NUMPY[column.type.value_type], copy=False)
                self._lists[name] = column.offsets.to_pylist(), numbers
            elif name != "world":
                self._scalars[name] = column.to_pylist()

    def scalar(self, name: str, row: int) -> Any:
        return self._scalars[name][row]

    def values(self, name: str, row: int) -> AnyArray:
        offsets, numbers = self._lists[name]
        return numbers[offsets[row] : offsets[row + 1]].copy()


def _episode(batch: _Columns, row: int) -> Episode:
    def scalar(name: str) -> Any:
        return batch.scalar(name, row)

    def values(name: str) -> AnyArray:
        return batch.values(name, row)

    steps, agents, bodies = scalar("steps"), scalar("agents"), scalar("bodies")
    size = {"T": steps, "T+1": steps + 1, "A": agents, "M": bodies, "2": 2}
    arrays = {
        name: values(name).reshape([size[axis] for axis in axes]) for name, axes in _AXES.items()
    }
    contacts = {name: values(f"contact_{name}") for name in _CONTACTS}
    latency, twist = scalar("latency_seconds"), scalar("twist")
    timings = Timings(
        values("decision_seconds"), scalar("planning_seconds"), scalar("batch"),
        None if latency is None else np.array(latency, np.float64), scalar("memory_bytes"),
        scalar("rehearsal_seconds") or 0.0,
    )  # fmt: skip
    world = world_from_json(batch.worlds[row].as_py())
    if (len(world.agents), len(world.bodies)) != (agents, bodies):
        raise ValueError(f"its world must have {agents} agents and {bodies} bodies")
    if len({len(array) for array in contacts.values()}) > 1:
        raise ValueError("its contacts must have one value in each column")
    held = None if twist is None else np.array(twist, np.bool_)
    if scalar("coded"):
        arrays |= state_codec.decoded(world, _twist(held, world), arrays)
    identity = {name: scalar(name) for name in (*_IDENTITY, "seed")}
    identity["navigator_hash"] = scalar("navigator_hash") or ""
    identity["source_hash"] = scalar("source_hash") or ""
    identity["rehearsal"] = scalar("rehearsal") or 0
    identity["perception"] = scalar("perception") or EXACT
    return Episode(
        identity=Identity(**identity),
        world=world,
        contacts=Contacts(**contacts),
        timings=timings,
        failure=scalar("failure"),
        reproducible=scalar("reproducible"),
        digest=scalar("digest"),
        rehearsals=scalar("rehearsals") or 0,
        rehearsal_decisions=scalar("rehearsal_decisions") or 0,
        remarks=tuple(scalar("remarks") or ()),
        traceback=scalar("traceback") or "",
        twist=held,
        undisturbed=None,
        **arrays,
    )


def _lists(arrays: Sequence[AnyArray], kind: pa.DataType) -> pa.Array:
    offsets = np.concatenate([[0], np.cumsum([a.size for a in arrays])]).astype(np.int64)
    dtype = _NUMPY[kind]
    flat = np.concatenate([np.asarray(a, dtype=dtype).ravel() for a in arrays])
    return pa.LargeListArray.from_arrays(pa.array(offsets), pa.array(flat, type=kind))
