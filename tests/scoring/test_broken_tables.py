"""Broken tables: one sentence with the place and the cure, and never another exception."""

import io

import numpy as np
import pandas as pd
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import benchnav
from benchnav.cli.main import status
from benchnav.errors import BenchnavError
from benchnav.scenario.importers.recording.formats import FORMATS
from benchnav.scoring.recording_file import read_recording
from benchnav.scoring.table_file import read_table
from benchnav.scoring.tracks import read_tracks

GOOD = "time,id,x,y\n" + "".join(f"{k / 10},{n},{k / 10},{n}\n" for k in range(6) for n in "ab")
WORDS = ("nan", "inf", "-1e300", "", "?", "1,5", "abc", "\0", "é", "0x10", "1e-320", "True")


def sentence(error, place):
    """Assert that an error is one short line with the place."""
    text = str(error)
    assert place in text
    assert "\n" not in text
    assert text.endswith(".")
    assert len(text) < 600


def read(path, format="csv"):
    """Read a table up to its tracks."""
    try:
        table = read_table(path, format, {}, 1.0)
        read_tracks(table, np.arange(len(table)), rate=10.0, step=None, gaps="refuse")
    except BenchnavError as error:
        sentence(error, str(path))


@st.composite
def broken(draw):
    """The text of a good table with a few changes."""
    content = bytearray(GOOD.encode())
    for _ in range(draw(st.integers(1, 4))):
        kind = draw(st.sampled_from(["cut", "word", "byte", "swap", "double"]))
        at = draw(st.integers(0, max(len(content) - 1, 0)))
        if kind == "cut":
            del content[at:]
        elif kind == "word":
            cells = bytes(content).split(b",")
            cells[draw(st.integers(0, len(cells) - 1))] = draw(st.sampled_from(WORDS)).encode()
            content = bytearray(b",".join(cells))
        elif kind == "byte" and content:
            content[at] = draw(st.integers(0, 255))
        elif kind == "swap":
            content = bytearray(bytes(content).replace(b",", draw(st.sampled_from([b";", b" "]))))
        else:
            content += content[at : at + 200]
    return bytes(content)


CHEAP = {"suppress_health_check": [HealthCheck.function_scoped_fixture], "deadline": None}


@settings(max_examples=300, **CHEAP)
@given(broken())
def test_a_broken_text_is_refused_in_a_sentence(tmp_path, content):
    path = tmp_path / "table.csv"
    path.write_bytes(content)
    read(path)


@settings(max_examples=100, **CHEAP)
@given(st.binary(max_size=400), st.sampled_from(["csv", "parquet"]))
def test_other_formats_are_refused_in_a_sentence(tmp_path, content, format):
    path = tmp_path / "table.bin"
    path.write_bytes(content)
    read(path, format)


@settings(max_examples=60, **CHEAP)
@given(st.data())
def test_a_broken_parquet_file_is_refused_in_a_sentence(tmp_path, data):
    whole = io.BytesIO()
    pd.read_csv(io.StringIO(GOOD)).to_parquet(whole)
    content = bytearray(whole.getvalue())
    for _ in range(data.draw(st.integers(1, 5))):
        content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    path = tmp_path / "table.parquet"
    path.write_bytes(content)
    read(path, "parquet")


@pytest.mark.parametrize(
    ("content", "text"),
    [
        (b"", "the file must hold a table; it is empty"),
        (b"time,id,x,y\n", "the table must have at least one row"),
        (b"time,id,x,y\n0,a,nan,0\n", r":2: x must be a number up to 1e\+07; got 'nan'"),
        (b"time,id,x,y\n0,a,0,0\n0.1,a,1e300,0\n", r":3: x must be a number up to 1e\+07"),
        (b"time,id,x,y\n0,a,0,0\n0,a,1,0\n", r":3: an id must have one row at a time; id a has"),
        (b"time,id,x\n0,a,0\n", r"there must be a column y; the file has time, id, x"),
        (
            b"t_ms,who,x\n0,a,0\n",
            r"must be columns id, y and time \[s\] or frame; the",
        ),
        ("time,id,x,y\n0,é,0,0\n".encode("latin-1"), r":2: the text must be encoded in UTF-8"),
        ("time,id,x,y\n0,a,0,0\n".encode("utf-16"), r":1: the text must be encoded in UTF-8"),
        (b"time,id,x,y\n0,a,0,0\n0.1,a,0\n0.2,a,0,0,0,0\n", r"each line must have as many cells"),
        (b"# note\ntime;id;x;y\n0;a;0;0\n0.1;a;?;0\n", r":4: x must be a number"),
        (b"time,id,x,y\n0,a,0,0\n1,a,0,0\n2.5,a,0,0\n3.5,a,0,0\n", r"times must be multiples"),
        (b"time,id,x,X\n0,a,0,0\n", r"one column must be the x; both 'x' and 'X' are"),
        (b"time,id,x,y\n0,a,0,0\n1e7,a,0,0\n0.001,a,0,0\n", r"gap|at most"),
    ],
)
def test_the_sentence_names_place_and_cure(tmp_path, content, text, capsys):
    path = tmp_path / "table.csv"
    path.write_bytes(content)
    assert status(["score", str(path)]) == 2
    stdout, stderr = capsys.readouterr()
    assert stdout == ""
    assert "Traceback" not in stderr
    assert pytest.importorskip("re").search(text, stderr), stderr


@pytest.mark.parametrize("format", ["csv", "parquet", *FORMATS, None])
def test_no_folder_no_device_and_nothing_missing(tmp_path, format):
    files = (tmp_path, tmp_path / "missing", "/dev/zero", "/dev/null")
    for file in files:
        with pytest.raises(BenchnavError, match=r"readable|cannot be read|must hold|format of"):
            benchnav.score(file, format=format, rate=10, quiet=True)
    noise = tmp_path / "noise"
    noise.write_bytes(b"\x00\x01noise" * 50)
    with pytest.raises(BenchnavError, match="noise"):
        benchnav.score(noise, format=format, rate=10, quiet=True)


@settings(max_examples=40, **CHEAP)
@given(
    st.binary(min_size=1, max_size=300),
    st.sampled_from([*FORMATS, None]),
)
def test_noise_is_no_recording(tmp_path, content, format):
    path = tmp_path / "noise.txt"
    path.write_bytes(content)
    try:
        read_recording(path, format, 10.0, 1.0)
    except BenchnavError as error:
        sentence(error, str(path))
