"""Where a report is written, and what a wrong place, run or option gets."""

import shutil

import pytest

import benchnav
from benchnav.cli.main import status
from benchnav.errors import CorruptPartError, MissingExtraError, StoreError, UsageError
from benchnav.report import shared_files
from benchnav.report.report_folder import MARKER, replaced_folder, require_replaceable

pytestmark = pytest.mark.usefixtures("report")


def test_an_earlier_report_is_replaced(run, tmp_path):
    out = tmp_path / "report"
    run.report(out, replays=1, quiet=True)
    assert (out / "replays").is_dir()
    run.report(out, replays=0, quiet=True)
    assert not (out / "replays").exists()
    assert [path.name for path in tmp_path.iterdir()] == ["report"]


def test_an_empty_folder_is_taken(tmp_path):
    (tmp_path / "out").mkdir()
    require_replaceable(tmp_path / "out")
    with replaced_folder(tmp_path / "out") as folder:
        (folder / "index.html").write_text("")
    assert (tmp_path / "out" / MARKER).is_file()


@pytest.mark.parametrize("name", ["thesis.txt", ".git"])
def test_other_files_are_never_removed(run, tmp_path, name):
    out = tmp_path / "report"
    run.report(out, replays=0, quiet=True)
    (out / name).write_text("mine")
    with pytest.raises(UsageError, match=f"holds {name}. Choose another folder"):
        run.report(out, quiet=True)
    assert (out / name).read_text() == "mine"


def test_a_report_is_not_written_into_a_run(run):
    for out in (run.path, run.path / "report"):
        with pytest.raises(UsageError, match="must not be written into a run"):
            run.report(out, quiet=True)


def test_a_file_is_not_a_folder(run, tmp_path):
    (tmp_path / "out").write_text("")
    with pytest.raises(UsageError, match="must be a folder"):
        run.report(tmp_path / "out", quiet=True)


def test_a_full_disk_leaves_the_earlier_report(tmp_path):
    out = tmp_path / "report"
    with replaced_folder(out) as folder:
        (folder / "index.html").write_text("old")
    with pytest.raises(StoreError, match="No space left on device"), replaced_folder(out):
        raise OSError(28, "No space left on device")
    assert (out / "index.html").read_text() == "old"
    assert [path.name for path in tmp_path.iterdir()] == ["report"]


def test_a_damaged_part_is_named(run, tmp_path):
    copy = tmp_path / "run"
    shutil.copytree(run.path, copy)
    part = sorted(copy.glob("parts/*/*episodes*"))[0]
    part.write_bytes(part.read_bytes()[:-1])
    assert status(["report", str(copy), "--out", str(tmp_path / "report")]) == 1
    assert not (tmp_path / "report").exists()
    damaged = benchnav.open_run(copy)
    with pytest.raises(CorruptPartError, match="is damaged"):
        damaged.report(tmp_path / "report", quiet=True)


def test_an_incomplete_run_is_shown_as_such(run, tmp_path):
    copy = tmp_path / "run"
    shutil.copytree(run.path, copy)
    shutil.rmtree(sorted(copy.glob("parts/odd*straight-line*"))[0])
    index = benchnav.open_run(copy).report(tmp_path / "report", replays=0, quiet=True)
    assert "The runs are incomplete: 2 episodes missing." in index.read_text("utf-8")


def test_what_is_not_a_run_is_refused(tmp_path, capsys):
    assert status(["report", str(tmp_path / "nothing"), "--out", str(tmp_path / "report")]) == 2
    assert "must be a run folder" in capsys.readouterr().err


def test_the_command_prints_the_first_page(run, tmp_path, capsys):
    words = [str(run.path), "--out", str(tmp_path / "report"), "--replays", "1"]
    assert status(["report", *words, "--metric", "success"]) == 0
    found = capsys.readouterr()
    assert found.out.strip() == str(tmp_path / "report" / "index.html")
    assert "and 1 replay, " in found.err


@pytest.mark.parametrize("words", [["--replays", "-1"], ["--metric", "sucess"]])
def test_wrong_options_are_refused(run, tmp_path, words):
    assert status(["report", str(run.path), "--out", str(tmp_path / "report"), *words]) == 2
    assert not (tmp_path / "report").exists()


def test_a_missing_library_is_named(run, tmp_path, monkeypatch):
    monkeypatch.setattr(shared_files, "DATATABLES", ("no_such_package", "x.js"))
    with pytest.raises(MissingExtraError, match=r"benchnav\[report\]"):
        run.report(tmp_path / "report", quiet=True)
