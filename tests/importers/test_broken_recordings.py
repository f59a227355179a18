"""Broken recordings: one sentence with the place and the cure, never a traceback or a full disk."""

import os
import random
import resource
import warnings

import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from benchnav import import_recording
from benchnav.errors import BenchnavError
from benchnav.scenario.importers.recording import FORMATS
from tests.importers.test_recording import WRITERS

JUNK = ["nan", "inf", "-inf", "1e400", "1e300", "-1", "0", "", "x", "NaN", "9" * 40, "\x00", "½"]
LONGEST = 1500  # characters of a message


class Originals(dict):
    """The bytes of the undamaged files by format; Hypothesis does not print them."""

    def __repr__(self):
        return "originals"


@pytest.fixture(scope="module")
def originals(tmp_path_factory):
    folder = tmp_path_factory.mktemp("originals")
    return Originals({name: write(folder).read_bytes() for name, (write, _) in WRITERS.items()})


def refused(path, out, **options):
    """Whether the import is refused; any other error than a sentence fails the test."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            import_recording(path, out, quiet=True, force=True, **options)
    except BenchnavError as error:
        text = str(error)
        assert text
        assert len(text) < LONGEST
        assert "Traceback" not in text
        assert text.replace(str(path), "").isprintable()
        return True
    return False


@st.composite
def damage(draw):
    """A function bytes → damaged bytes, and its name."""
    seed = draw(st.integers(0, 2**32 - 1))
    kind = draw(st.sampled_from(["cut", "flip", "token", "drop", "swap", "double", "utf-16"]))
    return kind, seed


def damaged(content, kind, seed):
    rng = random.Random(seed)
    data = bytearray(content)
    if kind == "cut":
        return bytes(data[: rng.randrange(len(data))])
    if kind == "flip":
        for _ in range(rng.randint(1, 20)):
            data[rng.randrange(len(data))] = rng.randrange(256)
        return bytes(data)
    if kind == "utf-16":
        return content.decode("latin-1").encode("utf-16")
    lines = content.decode("latin-1").split("\n")
    at = rng.randrange(len(lines))
    if kind == "token":
        words = lines[at].split(" ")
        words[rng.randrange(len(words))] = rng.choice(JUNK)
        lines[at] = " ".join(words)
    elif kind == "drop":
        del lines[at]
    elif kind == "swap":
        lines[at] = ";".join(lines[at].split()[::-1])
    else:
        lines.insert(at, lines[at])
    return "\n".join(lines).encode("latin-1")


@settings(
    max_examples=400, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(
    name=st.sampled_from(sorted(WRITERS)), harm=damage(),
    format=st.sampled_from([None, "same", *FORMATS]),
)  # fmt: skip
@example(name="jupedsim", harm=("token", 90418077), format=None)  # all columns are floats
def test_damaged_files(originals, tmp_path_factory, name, harm, format):
    folder = tmp_path_factory.getbasetemp() / "damaged"
    folder.mkdir(exist_ok=True)
    suffix = {"trajnetpp": ".ndjson", "hdf5": ".h5", "jupedsim": ".sqlite", "vadere": ".traj"}
    path = folder / f"{name}{suffix.get(name, '.csv.gz' if name == 'crowdit' else '.txt')}"
    path.write_bytes(damaged(originals[name], *harm))
    given_format = name if format == "same" else format
    refused(path, folder / "s.yaml", rate=10, format=given_format, unit="m")
    refused(path, folder / "s.yaml", format=given_format)


@settings(max_examples=150, deadline=None)
@given(content=st.binary(max_size=300), format=st.sampled_from([None, *FORMATS]))
def test_arbitrary_bytes(tmp_path_factory, content, format):
    folder = tmp_path_factory.getbasetemp()
    path = folder / "bytes.txt"
    path.write_bytes(content)
    refused(path, folder / "bytes.yaml", rate=10, format=format)


@pytest.mark.parametrize("format", [None, *FORMATS])
def test_what_is_no_file(tmp_path, format):
    os.mkfifo(tmp_path / "pipe.txt")
    (tmp_path / "empty.txt").touch()
    for path in (tmp_path, tmp_path / "pipe.txt", tmp_path / "missing.txt", "/dev/zero",
                 tmp_path / "empty.txt", tmp_path / "a\0b.txt"):  # fmt: skip
        assert refused(path, tmp_path / "s.yaml", rate=10, format=format)


BOMBS = {
    "vadere": "pedestrianId simTime endTime-PID1 startX-PID1 startY-PID1 endX-PID1 endY-PID1\n"
    "1 0 1e12 0 0 1 1\n",
    "text": "0 1 0 0\n1e8 1 1e8 0\n",
    "trajnetpp": "[" * 100_000,
    "juelich": "# framerate: 1e300\n# x/m\n1 1 0 0 0\n1 2 1 0 0\n",
    "pathfinder-json": '{"a": ' * 50_000,
}


@pytest.mark.parametrize("format", BOMBS)
def test_small_files_with_large_claims_stay_small(tmp_path, format):
    path = tmp_path / "bomb.txt"
    path.write_text(BOMBS[format])
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    refused(path, tmp_path / "s.yaml", rate=None if format == "juelich" else 10, format=format)
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 1 << 20  # [KiB]
