import os
from pathlib import Path

import numpy as np
import pytest

from benchnav.errors import ScenarioError
from benchnav.scenario.files.track_file import read_tracks
from benchnav.scenario.law import RecordedTrack

DATA = Path(os.environ.get("BENCHNAV_DATA", Path(__file__).parents[3] / "shared" / "data"))


def law(name, **changes):
    values = {"type": "recorded-track", "file": name, "format": "text", "frame_time": 0.4}
    return RecordedTrack.model_validate({**values, **changes})


def test_text(tmp_path):
    (tmp_path / "t.txt").write_text("10 2 1 5\n0 1 0 0\n10 1 ? ?\n20 1 2.5 1e0\n")
    first, second = read_tracks(law("t.txt"), tmp_path)
    np.testing.assert_allclose(first, [[0, 0, 0], [8, 2.5, 1]])
    np.testing.assert_allclose(second, [[4, 1, 5]])
    (only,) = read_tracks(law("t.txt", ids=(2,)), tmp_path)
    np.testing.assert_array_equal(only, second)


def test_trajnetpp(tmp_path):
    (tmp_path / "t.ndjson").write_text(
        '{"scene": {"id": 0}}\n{"track": {"f": 5, "p": 3, "x": 1, "y": 2}}\n\n'
        '{"track": {"f": 15, "p": 3, "x": 2, "y": 2}}\n'
    )
    (track,) = read_tracks(law("t.ndjson", format="trajnetpp", frame_time=0.04), tmp_path)
    np.testing.assert_allclose(track, [[0, 1, 2], [0.4, 2, 2]])


@pytest.mark.parametrize(
    ("text", "changes", "message"),
    [
        ("1 1 2\n", {}, r"t\.txt:1: must be four numbers: frame, id, x, y; got '1 1 2'\."),
        ("1 1 2 2\n1 1 3 3\n", {}, r"t\.txt:2: frame 1 of id 1 is repeated\."),
        ("1 1 inf 2\n", {}, r"t\.txt:1: must be four numbers"),
        ("1 1.5 0 2\n", {}, r"t\.txt:1: must be four numbers"),
        ("", {}, r"t\.txt:1: the file must hold at least one track\."),
        ("1 1 2 2\n", {"ids": (4,)}, r"t\.txt:1: the file must hold id 4; it has 1\."),
        ("[1]\n", {"format": "trajnetpp"}, r"t\.txt:1: must be \{\"scene\""),
        ('{"track": {"f": 1}}\n', {"format": "trajnetpp"}, r"t\.txt:1: must be"),
    ],
)
def test_refusals(tmp_path, text, changes, message):
    (tmp_path / "t.txt").write_text(text)
    with pytest.raises(ScenarioError, match=message):
        read_tracks(law("t.txt", **changes), tmp_path)


def test_not_text(tmp_path):
    (tmp_path / "t.txt").write_bytes(b"\xff\xfe")
    with pytest.raises(ScenarioError, match="cannot be read"):
        read_tracks(law("t.txt"), tmp_path)


def test_real_recording():
    folder = DATA / "trajnetpp"
    if not folder.is_dir():
        pytest.skip(f"no recordings in {folder}: set BENCHNAV_DATA")
    track, *others = read_tracks(
        law("collision_test.ndjson", format="trajnetpp", frame_time=0.4), folder
    )
    assert len(others) == 1
    np.testing.assert_allclose(track[:2], [[0, 0.1, 6.2], [0.4, 0.1, 5.8]])


def test_columns_comments_and_headers(tmp_path):
    expected = [[0, 0, 5], [0.4, 0.1, 5]]
    tables = {
        "frame,id,x,y\n0,1,0,5\n1,1,0.1,5\n": {},
        "# framerate: 25 fps\n# id frame x/m y/m z/m\n1 0 0 5 1.7\n1 1 0.1 5 1.7\n": {},
        "1e0 0 9 0.0 9 5\n1 1 9 0.1 9 5\n": {"columns": ("id", "frame", "_", "x", "_", "y")},
        "0 1 0 0 5 1 0 0\n1 1 0.1 0 5 1 0 0\n": {},  # obsmat.txt
    }
    for text, changes in tables.items():
        (tmp_path / "t.txt").write_text(text)
        (track,) = read_tracks(law("t.txt", **changes), tmp_path)
        np.testing.assert_allclose(track, expected)
    (tmp_path / "t.txt").write_text("1 0 0 5 1.7\n")
    with pytest.raises(ScenarioError, match=r"t\.txt:1: the file has 5 columns and no header"):
        read_tracks(law("t.txt"), tmp_path)


def test_gaps(tmp_path):
    rows = [f"{f} 7 {f} 0" for f in (0, 1, 2, 3, 30, 31, 32)]
    (tmp_path / "t.txt").write_text("\n".join(rows))
    message = r"t\.txt:5: the track of id 7 has a gap of 10\.8 s, between the frames 3 and 30\."
    with pytest.raises(ScenarioError, match=message):
        read_tracks(law("t.txt"), tmp_path)
    (whole,) = read_tracks(law("t.txt", gaps="bridge"), tmp_path)
    assert len(whole) == 7
    parts = read_tracks(law("t.txt", gaps="split", presence="recorded"), tmp_path)
    assert [len(part) for part in parts] == [4, 3]
    with pytest.raises(ValueError, match="must not be `split` without `presence: recorded`"):
        law("t.txt", gaps="split")


def test_a_few_missing_rows_are_no_gap(tmp_path):
    (tmp_path / "t.txt").write_text("\n".join(f"{f} 7 {f} 0" for f in (0, 1, 2, 4, 5)))
    (track,) = read_tracks(law("t.txt"), tmp_path)
    assert len(track) == 5
