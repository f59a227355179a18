"""Trajectories of episodes as files and tables of other programs."""

from collections.abc import Iterable, Iterator, Sequence
from contextlib import ExitStack
from itertools import chain, count
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from benchnav.arena.world import Afterwards
from benchnav.arrays import BoolArray
from benchnav.episode.episode import Episode as Record
from benchnav.episode.episode import Status
from benchnav.errors import UsageError, did_you_mean
from benchnav.metrics.quantities.density import walkable_area
from benchnav.metrics.quantities.episode_analysis import analyse
from benchnav.scoring.bodies import shape_columns
from benchnav.system.plain_file import writing
from benchnav.text.file_name import file_name

if TYPE_CHECKING:
    import pandas as pd

FORMATS = ("csv", "parquet", "pedpy")


def export(records: Iterable[Record], out: Path, to: str) -> list[Path]:
    """Write the trajectories of episodes, one episode in memory at a time; return the files.

    "csv" and "parquet" are one table of all episodes, which `benchnav.score` reads. "pedpy" is a
    folder with a text file and the walkable area (WKT) of each episode.

    Raises UsageError for another format or a wrong name, StoreError if a file cannot be written.
    """
    if to not in FORMATS:
        raise UsageError(
            f"The format must be one of {', '.join(FORMATS)}. Got {to!r} instead."
            f"{did_you_mean(to, FORMATS)}"
        )
    if to == "pedpy":
        written: list[Path] = []
        for record in records:
            written += _write_pedpy(record, out, written)
        return written
    if out.suffix.lower() != f".{to}":
        raise UsageError(f"The file of the format {to} must end in .{to}. Got {out} instead.")
    with writing(out):
        _write_table(map(trajectory_table, records), out, to)
    return [out]


def trajectory_table(record: Record) -> "pd.DataFrame":
    """Return one row for each agent and time at which it is in the arena.

    The columns are those that `benchnav.score` reads. The last row of an agent that arrives and
    vanishes has the time of its arrival, which can be between two decisions.
    """
    import pandas as pd

    agents, identity, here = record.world.agents, record.identity, present(record)
    state, agent = np.nonzero(here)
    time = record.times[state]
    late = analyse(record).trajectories
    leaves = late.leaves < len(record.position)
    final = (state == late.last[agent]) & leaves[agent] & ~np.isnan(record.arrival[agent])
    time = np.where(final, np.minimum(time, late.end[agent]), time)
    status = np.array([status.name.lower() for status in Status], dtype=object)
    return pd.DataFrame(
        {
            "navigator": identity.navigator, "scenario": identity.scenario,
            "track": identity.track, "perception": identity.perception, "split": identity.split,
            "seed": identity.seed,
            "time": time, "id": agent,
            "x": record.position[state, agent, 0], "y": record.position[state, agent, 1],
            "heading": record.heading[state, agent], "radius": agents.radius[agent],
            **{name: column[agent] for name, column in shape_columns(agents).items()},
            "goal_x": agents.goal[agent, 0], "goal_y": agents.goal[agent, 1],
            "preferred_speed": agents.preferred_speed[agent],
            "team": np.array(record.world.teams, dtype=object)[agents.team[agent]],
            "status": status[record.status[state, agent]],
        }
    )  # fmt: skip


def pedpy_trajectories(record: Record) -> Any:
    """Return the trajectories as PedPy's `TrajectoryData`: a frame is a decision time."""
    import pandas as pd
    import pedpy

    state, agent = np.nonzero(present(record))
    data = pd.DataFrame(
        {
            "id": agent, "frame": state,
            "x": record.position[state, agent, 0], "y": record.position[state, agent, 1],
        }
    ).sort_values(["id", "frame"], ignore_index=True)  # fmt: skip
    return pedpy.TrajectoryData(data=data, frame_rate=1.0 / record.world.clock.dt)


def present(record: Record) -> BoolArray:
    """Return whether each agent is in the arena at each state, (T+1, A)."""
    states = np.arange(len(record.position))[:, None]
    rules, final = record.world.rules, record.status[-1]
    gone = (final == int(Status.ARRIVED)) & (rules.on_arrival == Afterwards.VANISH)
    gone |= (final == int(Status.ENDED)) & (rules.on_end == Afterwards.VANISH)
    here = ~gone | (states <= analyse(record).trajectories.last)
    inside: BoolArray = here & (record.status != int(Status.WAITING))
    return inside


def _write_table(tables: "Iterator[pd.DataFrame]", out: Path, to: str) -> None:
    if to == "csv":
        with out.open("w", encoding="utf-8", newline="") as file:
            for number, table in enumerate(tables):
                table.to_csv(file, index=False, header=number == 0, lineterminator="\n")
        return
    import pyarrow as pa
    import pyarrow.parquet as pq

    with ExitStack() as stack:
        writer: Any = None
        for table in tables:
            rows = pa.Table.from_pandas(table, preserve_index=False)
            if writer is None:
                writer = stack.enter_context(pq.ParquetWriter(out, rows.schema))
            writer.write_table(rows)


def _write_pedpy(record: Record, folder: Path, taken: Sequence[Path]) -> list[Path]:
    """Write a recording and its walkable area under a name that is not ``taken``."""
    identity, found = record.identity, pedpy_trajectories(record)
    words = [identity.navigator, identity.scenario, identity.track]
    words += ["noisy"] if identity.perception == "noisy" else []
    endings = chain([""], (f"-{number}" for number in count(2)))
    stems = (file_name(*words, suffix=f"-{identity.seed}{ending}") for ending in endings)
    stem = next(stem for stem in stems if folder / f"{stem}.txt" not in taken)
    text, area = folder / f"{stem}.txt", folder / f"{stem}.wkt"
    with writing(text), text.open("w", encoding="utf-8", newline="") as file:
        file.write(f"# framerate: {found.frame_rate!r}\n# id frame x/m y/m z/m\n")
        rows = found.data[["id", "frame", "x", "y"]].assign(z=0)
        rows.to_csv(file, sep=" ", index=False, header=False, lineterminator="\n")
    with writing(area):
        area.write_text(walkable_area(record.world).wkt + "\n", encoding="utf-8")
    return [text, area]
