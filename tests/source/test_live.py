"""The source hash of classes that a notebook or a script defines."""

import linecache
import sys
from types import ModuleType
from unittest.mock import Mock

import pytest

from benchnav.plugins import NAVIGATORS, register_navigator
from benchnav.source.digest import source_hash
from benchnav.source.importable import is_importable

CELL = """
from benchnav.navigation.navigator import AgentNavigator, PluginConfig
import numpy as np
GAIN = {gain}
TABLE = np.array([{table}])
def helper(way):
    return {helper} * way
class Base(AgentNavigator):
    factor = {factor}
    class Config(PluginConfig):
        speed: float = 1.0
class Live(Base):
    @property
    def twice(self):
        return {twice}
    @staticmethod
    def still(x={default}):
        return x
    def act_agent(self, view, briefing):
        way = helper(view.goal - view.position)
        return GAIN * way * TABLE[0] * self.factor
"""
PLAIN = {"gain": 1, "table": 1.0, "helper": 1, "factor": 1, "twice": 2, "default": 0}


@pytest.fixture(params=["with text", "without text"])
def notebook(request, monkeypatch):
    """Run a cell as a kernel does; (place of its class, hash)."""
    count = iter(range(1000))
    main = ModuleType("__main__")
    monkeypatch.setitem(sys.modules, "__main__", main)

    def run(**changed):
        code = CELL.format(**PLAIN | changed)
        name = f"<cell {next(count)}>"
        if request.param == "with text":
            lines = code.splitlines(keepends=True)
            monkeypatch.setitem(linecache.cache, name, (len(code), None, lines, name))
        exec(compile(code, name, "exec"), vars(main))
        register_navigator("live-for-a-test")(main.Live)
        return source_hash(["__main__:Live"])

    yield run
    NAVIGATORS._local.pop("live-for-a-test", None)


def test_a_cell_that_is_run_again_as_it_was_has_the_same_hash(notebook):
    assert notebook() == notebook()


@pytest.mark.parametrize("what", PLAIN)
def test_what_was_edited_in_a_cell_counts(notebook, what):
    assert notebook() != notebook(**{what: 7})


def test_a_class_made_by_a_function_counts_with_what_it_closes_over(monkeypatch):
    def make(gain):
        class Made:
            def act(self):
                return gain

        return Made

    hashes = []
    for gain in (1, 2, 1):
        monkeypatch.setitem(NAVIGATORS._local, "made-for-a-test", (make(gain), "tests:Made"))
        hashes.append(source_hash(["tests:Made"]))
    assert hashes[0] == hashes[2] != hashes[1]


def test_modules_of_ones_own_that_a_cell_uses_count(notebook, tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(str(tmp_path))
    (tmp_path / "lib_of_a_cell.py").write_text("x = 1\n")
    changed = {"gain": "__import__('lib_of_a_cell')", "helper": "GAIN.x"}
    before = notebook(**changed)
    (tmp_path / "lib_of_a_cell.py").write_text("x = 2\n")
    assert notebook(**changed) != before
    del sys.modules["lib_of_a_cell"]


def test_what_other_processes_can_import(tmp_path, monkeypatch):
    class Local: ...

    main = ModuleType("__main__")
    monkeypatch.setitem(sys.modules, "__main__", main)
    code = "class Top: ...\nif __name__ == '__main__':\n    class Guarded: ...\n"
    exec(code, vars(main))
    assert not is_importable(main.Top)  # a notebook's
    main.__file__ = str(tmp_path / "script.py")
    (tmp_path / "script.py").write_text(code)
    assert is_importable(main.Top)
    assert not is_importable(main.Guarded)
    assert not is_importable(Local)
    assert is_importable(Mock)
