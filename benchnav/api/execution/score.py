"""Scores of trajectories that other programs recorded or simulated."""

from collections.abc import Iterable, Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from benchnav.api.output.messages import message, silent
from benchnav.api.records.leaderboard import Leaderboard
from benchnav.errors import UsageError, did_you_mean
from benchnav.processes.main_module import stop_import_of_main

if TYPE_CHECKING:
    from benchnav.scoring.table_file import Table

TABLES = {".csv": "csv", ".parquet": "parquet", ".pq": "parquet"}
GOALS = ("columns", "last")


def score(
    files: "str | PathLike[str] | Iterable[str | PathLike[str]]",
    *,
    format: str | None = None,
    scenario: "str | PathLike[str] | Iterable[str | PathLike[str]]" = (),
    seed: int = 0,
    track: str = "known",
    perception: str = "exact",
    label: str | None = None,
    rate: float | None = None,
    unit: float | None = None,
    step: float | None = None,
    gaps: str = "refuse",
    columns: Mapping[str, str] | None = None,
    radius: float | None = None,
    preferred_speed: float | None = None,
    goals: str = "columns",
    goal_tolerance: float | None = None,
    area: "Iterable[float] | None" = None,
    metrics: "str | Sequence[str] | None" = None,
    quiet: bool = False,
) -> Leaderboard:
    """Measure tables of trajectories, and return the table of every metric.

    A metric that needs what the files do not hold is n/a, with the reason. Each file is one
    navigator, unless it has a column navigator. Columns that are recognised: time [s] or frame,
    id, x, y [m]; and, where they exist, heading [rad], radius, goal_x, goal_y [m],
    body_length, body_width, corner_radius [m] of a body that is not a disc, preferred_speed [m/s],
    team, navigator, scenario, track, perception, split, seed.

    Args:
        files: one file or several.
        format: csv, parquet, or a format of `benchnav.import_recording`, such as eth, trajnetpp,
            juelich, hdf5, jupedsim, vadere; None: by suffix and content.
        scenario: name or file, or several for a table with a column scenario: its walls, rules
            and horizon count, and its agents if they start where the ids do.
        seed: of the scenario's world, for a table without a column seed.
        track: the knowledge track, for a table without a column track.
        perception: exact or noisy, for a table without a column perception.
        label: of the navigator; None: the file's name.
        rate: [Hz] of the column frame, or of the file's frames.
        unit: [m] of the file's unit of length; None: 1, or as the file declares.
        step: [s]: interpolate the tracks at multiples of this time; None: the table's own step.
        gaps: what happens to an id that is missing for a time: refuse, bridge or split.
        columns: column of benchnav → column of the file, where it is not recognised.
        radius: [m] of all ids, for a table without a column radius.
        preferred_speed: [m/s] of all ids, likewise.
        goals: "columns", or "last": the goal of an id is its last position.
        goal_tolerance: [m]; None: of the scenario, else 0.3; 0 for last positions.
        area: xmin, ymin, xmax, ymax [m] of the measurement area for densities and flow.
        metrics: names of the metrics to show; None: all.
        quiet: print no remarks.

    Raises TrajectoryError with the place for a wrong file, UsageError for a mistake in the call.
    """
    stop_import_of_main()
    import pyarrow as pa

    from benchnav.leaderboard.from_runs import StoredValues
    from benchnav.metrics.declared import declared_metrics
    from benchnav.scenario.catalogue import find
    from benchnav.scoring.score import Reading, Subject, score_table
    from benchnav.scoring.setting import Options

    say = silent if quiet else message
    paths = [Path(file) for file in _list(files)]
    _demand_one_of("gaps", gaps, ("refuse", "bridge", "split"))
    _demand_one_of("goals", goals, GOALS)
    _demand_positive(
        rate=rate, unit=unit, step=step, radius=radius, preferred_speed=preferred_speed
    )
    if goal_tolerance is not None and not 0.0 <= goal_tolerance < float("inf"):
        raise UsageError(f"goal_tolerance must be ≥ 0 m. Got {goal_tolerance} instead.")
    if not paths:
        raise UsageError("There must be at least one file to score. Got none.")
    if label is not None and len(paths) > 1:
        raise UsageError("A label names one file. Got several files: leave it out.")
    options = Options(
        radius=radius, preferred_speed=preferred_speed, goals=goals,  # type: ignore[arg-type]
        goal_tolerance=goal_tolerance, area=_area(area),
    )  # fmt: skip
    reading = Reading(rate=rate, step=step, gaps=gaps)  # type: ignore[arg-type]
    drawn = {each.identity: each for each in (find(str(name)) for name in _list(scenario))}
    installed, broken = declared_metrics()
    for cause in broken:
        say(f"{cause} It is left out.")
    tables, remarks = [], dict[str, None]()
    for path in paths:
        table = _read(path, format, columns or {}, rate, unit)
        subject = Subject(
            navigator=label or path.stem, track=track, perception=perception, seed=seed,
            scenarios=drawn,
        )  # fmt: skip
        found, more = score_table(table, subject, reading, options, list(installed.values()))
        tables.append(found)
        remarks |= dict.fromkeys(more)
    for remark in remarks:
        say(remark)
    values = StoredValues(
        results=pa.concat_tables(tables), metrics=installed, caveats=(), not_applicable=(),
        verified=(), facts={},
    )  # fmt: skip
    if metrics is None:
        return Leaderboard(values, ["all"])
    return Leaderboard(values, [metrics] if isinstance(metrics, str) else list(metrics))


def _read(
    path: Path, format: str | None, columns: Mapping[str, str], rate: float | None,
    unit: float | None,
) -> "Table":  # fmt: skip
    from benchnav.scenario.importers.recording.formats import FORMATS
    from benchnav.scoring.recording_file import read_recording
    from benchnav.scoring.table_file import read_table

    kind = format or TABLES.get(path.suffix.lower())
    if kind is not None:
        _demand_one_of("format", kind, ("csv", "parquet", *FORMATS))
    if kind in ("csv", "parquet"):
        return read_table(path, kind, columns, 1.0 if unit is None else unit)
    if columns:
        raise UsageError(f"Columns are named in csv and parquet files; {path} is a recording.")
    return read_recording(path, kind, rate, unit)


def _list(names: "str | PathLike[str] | Iterable[str | PathLike[str]]") -> Sequence[Any]:
    return [names] if isinstance(names, (str, PathLike)) else list(names)


def _demand_one_of(name: str, value: str, allowed: Iterable[str]) -> None:
    known = tuple(allowed)
    if value not in known:
        raise UsageError(
            f"{name} must be one of {', '.join(known)}. Got {value!r} instead."
            f"{did_you_mean(str(value), known)}"
        )


def _demand_positive(**values: float | None) -> None:
    for name, value in values.items():
        if value is not None and not 0.0 < value < float("inf"):
            raise UsageError(f"{name} must be > 0. Got {value} instead.")


def _area(area: "Iterable[float] | None") -> tuple[float, float, float, float] | None:
    if area is None:
        return None
    found = tuple(float(number) for number in area)
    if len(found) != 4 or not (found[0] < found[2] and found[1] < found[3]):
        raise UsageError(f"area must be xmin, ymin, xmax, ymax with min < max. Got {found}.")
    return found[0], found[1], found[2], found[3]
