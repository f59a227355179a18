"""What the fork server loads before it forks; two processes share a first compile."""

import os

import pytest

from benchnav.runner.execute import preload


@pytest.fixture
def order(monkeypatch, tmp_path):
    """Return the parts that each process uses, as {process number: names}."""
    log = tmp_path / "log"

    def note(name):
        with log.open("a") as file:
            file.write(f"{os.getpid()} {name}\n")

    monkeypatch.setattr(preload, "_measure", lambda: note("measure"))
    monkeypatch.setattr(preload, "_observe", lambda need: note(need))
    monkeypatch.setattr(preload, "_find_path", lambda: note("path"))

    def run(folder, cores=2):
        monkeypatch.setattr(preload, "cache_folder", lambda package: folder)
        monkeypatch.setattr(preload, "core_count", lambda: cores)
        for helper in preload.warm():
            if helper is not None:
                os.waitpid(helper, 0)
        found: dict[int, list[str]] = {}
        for line in log.read_text().splitlines():
            pid, name = line.split()
            found.setdefault(int(pid), []).append(name)
        return found

    return run


def test_a_second_process_compiles_in_the_opposite_order(order, tmp_path):
    own, other = (found := order(tmp_path / "missing")).pop(os.getpid()), *found.values()
    assert own[0] == "measure"
    assert own[-1] == "path"
    assert other == own[::-1]


@pytest.mark.parametrize("case", ["compiled", "no cache", "one core"])
def test_one_process_is_enough_to_load(order, tmp_path, case):
    folder = {"compiled": tmp_path, "no cache": None, "one core": tmp_path / "missing"}[case]
    assert list(order(folder, 1 if case == "one core" else 2)) == [os.getpid()]


def test_every_part_runs():
    assert all(step is None or step > 0 for step in preload.warm())
