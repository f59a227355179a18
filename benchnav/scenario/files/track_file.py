"""Recorded tracks: rows sorted by person and time, and gaps within a track."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np

from benchnav.arrays import BoolArray, FloatArray, IntArray
from benchnav.errors import ScenarioError
from benchnav.scenario.files.track_rows import Rows, read_rows
from benchnav.scenario.law import Gaps, RecordedTrack

MAX_TRACKS = 2000
LONGEST = 1.0  # [s] of a time without rows that is no gap
_STEPS = 2.0  # usual steps, likewise
_SAMPLES = 10  # of ids, in a message


@dataclass(frozen=True, eq=False)
class Track:
    """The path of one person, or a piece of it between gaps."""

    number: int  # id of the person
    time: FloatArray  # (T,) [s], rising; 0 is the first frame of the recording
    place: FloatArray  # (T, 2) as recorded


def read_tracks(law: RecordedTrack, folder: Path) -> list[FloatArray]:
    """Return one array (T, 3) of time [s], x, y (as recorded) per track, by ascending id.

    Time 0 is the recording's first frame. Rows without a place are left out.

    Raises:
        ScenarioError: the file is not of its format, has not all ids that the law names, or has a
            gap that the law refuses.
    """
    path = folder / (law.file or "")
    rows = read_rows(path, law.format or "text", law.columns)
    tracks = tracks_of(rows, law.frame_time or 1.0, law.gaps, law.ids)
    if len(tracks) > MAX_TRACKS:
        raise ScenarioError(f"{path}:1: there are more than {MAX_TRACKS} tracks: choose `ids`.")
    return [np.column_stack([track.time, track.place]) for track in tracks]


def tracks_of(
    rows: Rows, frame_time: float, gaps: Gaps, ids: Sequence[int] | None = None
) -> list[Track]:
    """Return the tracks of a recording, in the order of ``ids`` or by ascending id.

    Args:
        rows: of the recording.
        frame_time: time [s] between successive frame numbers.
        gaps: what to do with a time without rows that is longer than 1 s and two usual steps.
        ids: of the persons; None: all.

    Raises:
        ScenarioError: a frame of a person is repeated, an id is missing, or a gap is refused.
    """
    order = np.lexsort((rows.frame, rows.number))
    number, frame, place = rows.number[order], rows.frame[order], rows.place[order]
    same = number[1:] == number[:-1]
    step = np.diff(frame)
    _refuse_repeats(rows, order, same & (step == 0.0))
    gap = same & _is_gap(step, step[same], frame_time)
    if gaps == "refuse" and gap.any():
        _refuse_gap(rows, order, gap, frame_time)
    cut = ~same if gaps == "bridge" else ~same | gap
    ends = [0, *(np.flatnonzero(cut) + 1).tolist(), len(number)]
    time = (frame - frame.min()) * frame_time
    found: dict[int, list[Track]] = {}
    for low, high in pairwise(ends):
        track = Track(int(number[low]), time[low:high], place[low:high])
        found.setdefault(track.number, []).append(track)
    for wanted in ids or ():
        if wanted not in found:
            some = ", ".join(map(str, list(found)[:_SAMPLES]))
            raise ScenarioError(f"{rows.path}:1: the file must hold id {wanted}; it has {some}.")
    return [track for n in (found if ids is None else ids) for track in found[n]]


def _is_gap(step: FloatArray, within: FloatArray, frame_time: float) -> BoolArray:
    """Return which steps (N,) in frames are gaps; ``within`` are the steps of the tracks."""
    if not len(within):
        return np.zeros(len(step), np.bool_)
    steps, counts = np.unique(within, return_counts=True)
    usual = float(steps[np.argmax(counts)])
    longest = max(LONGEST, _STEPS * usual * frame_time)
    long: BoolArray = step * frame_time > longest * (1.0 + 1e-9)
    return long


def _refuse_repeats(rows: Rows, order: IntArray, repeated: BoolArray) -> None:
    if repeated.any():
        k = order[np.flatnonzero(repeated)[0] + 1]
        raise ScenarioError(
            f"{rows.path}:{rows.line[k]}: frame {rows.frame[k]:g} of id {rows.number[k]}"
            " is repeated."
        )


def _refuse_gap(rows: Rows, order: IntArray, gap: BoolArray, frame_time: float) -> None:
    at = int(np.flatnonzero(gap)[0])
    before, after = order[at], order[at + 1]
    count = int(gap.sum())
    more = f" There are {count} such gaps." if count > 1 else ""
    seconds = (rows.frame[after] - rows.frame[before]) * frame_time
    raise ScenarioError(
        f"{rows.path}:{rows.line[after]}: the track of id {rows.number[after]} has a gap of"
        f" {seconds:g} s, between the frames {rows.frame[before]:g} and {rows.frame[after]:g}."
        f"{more} Set `gaps` to `split`, so that the person vanishes and appears, or to `bridge`,"
        " so that it walks straight on."
    )
