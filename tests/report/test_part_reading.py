"""The stored episodes are read once, in this process or in several, with the same result."""

import shutil

import pytest

import benchnav
from benchnav.errors import CorruptPartError
from benchnav.leaderboard.from_runs import stored_values
from benchnav.report import part_reading
from benchnav.report.failed_episodes import choose_replays, find_failures
from benchnav.report.part_reading import readings_of
from benchnav.report.replays import ReplayPlan
from benchnav.report.report_data import read_runs
from benchnav.runner.execute.progress import Progress


class Counted(Progress):
    def begin(self, total, stored):
        self.total, self.done, self.ended = total, stored, False

    def advance(self, episodes):
        self.done += episodes

    def end(self):
        self.ended = True


def read(run, folder):
    folder.mkdir()
    values, progress = stored_values([run.folder], notify=print), Counted()
    failed = choose_replays(find_failures(values.results), 100)
    plan = ReplayPlan({f.cell: f.seed for f in failed}, folder)
    data = read_runs([run.folder], values, plan=plan, progress=progress)
    assert (progress.done, progress.ended) == (progress.total, True)
    assert len(data.replays) == len(failed) > 0
    return data, {path.name: path.read_bytes() for path in (folder / "replays").iterdir()}


def test_processes_read_what_one_process_reads(run, tmp_path, monkeypatch):
    here, pages = read(run, tmp_path / "here")
    monkeypatch.setattr(part_reading, "MANY", 1)
    monkeypatch.setattr(part_reading, "core_count", lambda: 2)
    apart, other_pages = read(run, tmp_path / "apart")
    assert pages == other_pages
    assert repr(here.summaries) == repr(apart.summaries)
    assert [s.seeds for s in here.scenarios] == [s.seeds for s in apart.scenarios] == [(0, 1)] * 2
    assert here.replays == apart.replays


def test_an_episode_of_two_runs_is_read_once(run):
    once, twice = (readings_of([run.folder] * n, None) for n in (1, 2))
    assert sum(len(r.seeds) for r in twice) == sum(len(r.seeds) for r in once)
    assert {w for r in twice if r.scenario == "trap/u@1" for w in r.worlds} == {0, 1}
    assert sum(len(r.worlds) for r in twice) == 4  # two scenarios, two seeds


def test_a_damaged_part_is_named_by_a_process_too(run, tmp_path, monkeypatch):
    copy = benchnav.open_run(shutil.copytree(run.path, tmp_path / "copy"))
    values = stored_values([copy.folder], notify=print)
    damaged = next((tmp_path / "copy" / "parts").glob("*/*episodes*"))
    damaged.write_bytes(b"x" + damaged.read_bytes()[1:])
    monkeypatch.setattr(part_reading, "MANY", 1)
    monkeypatch.setattr(part_reading, "core_count", lambda: 2)
    with pytest.raises(CorruptPartError, match="is damaged"):
        read_runs([copy.folder], values)
