"""A Ray worker runs tasks with the files that it is sent, and returns sealed parts."""

import shutil
import sys
import types
from dataclasses import replace

import pytest

from benchnav.errors import CorruptPartError
from benchnav.runner.plan.limits import Limits
from benchnav.runner.plan.suite import Selection, load_suite
from benchnav.runner.plan.task import Task
from benchnav.runner.ray.ray_worker import RayWorker, Refusal
from benchnav.runner.run import run_suite
from benchnav.store.parts.part import SEAL, Part
from benchnav.store.parts.part_writer import receive
from benchnav.store.runs.reading import read_episodes

MAPPED = """
name: tiny/mapped
title: Two discs beside a wall that a file draws
bounds: [0, 0, 8, 8]
walls:
  - shape: {type: occupancy, file: maps/wall.map, format: movingai, cell: 1.0}
teams:
  - name: us
    count: 2
    radius: 0.3
    max_speed: 1
    start: {type: region, region: {type: anywhere}, separation: 0.3}
    goal: {type: region, region: {type: anywhere}, min_distance: 3}
clock: {dt: 0.2, substeps: 2, horizon: 4}
"""


@pytest.fixture
def ray_worker(monkeypatch):
    monkeypatch.setitem(sys.modules, "__main__", types.ModuleType("__main__"))
    ray_worker = RayWorker(Limits(timeout=60.0), sys.path)
    yield ray_worker
    ray_worker.close()
    assert not ray_worker._home.path.exists()


def task_of(suite, tmp_path, **changes):
    (job,) = suite.jobs()
    task = Task(job, tmp_path / "run" / "parts" / job.key, 0, 2, salt="5a" * 16, probe=0)
    return replace(task, **changes)


def test_the_guilty_seed_is_found_and_charged_where_it_ran(
    ray_worker, tmp_path, scenario_file, troubled
):
    path = tmp_path / "suite.yaml"
    path.write_text(
        f"name: small\nscenarios: [{scenario_file}]\nseeds: '3:5'\n"
        "navigators: ['troubled_navigators:Dies']\n"
    )
    suite = load_suite(str(path))
    pieces = ray_worker.work(task_of(suite, tmp_path, first=3, stop=5), {})
    found = {p.task.first: [why for _, why in p.outcome.failures] for p in pieces}
    assert found == {3: ["the navigator's process ended with exit status 7"], 4: []}
    for piece in pieces:
        part = Part(piece.task.folder, piece.task.first, piece.task.stop)
        assert str(part.folder).startswith(str(tmp_path))
        with pytest.raises(CorruptPartError, match="does not match the files that came with it"):
            receive(part, {s: c if s == SEAL else c[:-1] for s, c in piece.files.items()})
        with pytest.raises(CorruptPartError, match="is damaged"):
            receive(part, {s: c for s, c in piece.files.items() if s != SEAL})
        assert not part.sealed
        receive(part, piece.files)
        assert [e.identity.seed for e in part.episodes()] == list(part.seeds)
        assert not list(part.folder.glob(".writing*"))


def test_files_of_a_scenario_need_not_be_there(ray_worker, tmp_path):
    home = tmp_path / "home"
    (home / "maps").mkdir(parents=True)
    rows = ["........"] * 3 + ["..@@@@.."] + ["........"] * 4
    (home / "maps/wall.map").write_text(
        "\n".join(["type octile", "height 8", "width 8", "map", *rows])
    )
    (home / "mapped.yaml").write_text(MAPPED)
    (home / "suite.yaml").write_text(
        "name: small\nscenarios: [mapped.yaml]\nseeds: 2\nnavigators: [orca]\n"
    )
    suite = load_suite(str(home / "suite.yaml"), Selection(salt="5a" * 16))
    run_suite(suite, tmp_path / "here", workers=0)
    task = task_of(suite, tmp_path)
    files = {n: p.read_bytes() for n, p in task.job.scenario.named_files().items()}
    assert list(files) == ["maps/wall.map"]
    shutil.rmtree(home)
    refusal = ray_worker.work(task, {"/leads/out": b""})
    assert isinstance(refusal, Refusal)
    assert refusal.name == "CorruptPartError"
    for _ in range(2):  # staged once
        (piece,) = ray_worker.work(task, files)
    part = Part(piece.task.folder, 0, 2)
    receive(part, piece.files)
    assert [e.digest for e in part.episodes()] == [
        e.digest for e in read_episodes(tmp_path / "here")
    ]
