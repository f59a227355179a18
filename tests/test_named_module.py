"""What ``module:attribute`` finds in the current folder, and what it never does."""

import sys

import pytest

from benchnav.errors import BrokenPluginError
from benchnav.plugins import NAVIGATORS

MODULE = """
from benchnav_baselines.navigators.straight_line import StraightLine
{imports}

class Mine(StraightLine):
    class Nested(StraightLine):
        pass
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [entry for entry in sys.path if entry not in ("", ".")])
    before = set(sys.modules)
    yield tmp_path
    for name in set(sys.modules) - before:
        if not name.startswith("benchnav"):
            del sys.modules[name]


def test_modules_and_packages_of_the_current_folder_are_found(folder):
    (folder / "found_helper.py").write_text("VALUE = 3\n")
    (folder / "found_here.py").write_text(MODULE.format(imports="import found_helper"))
    (folder / "found_package").mkdir()
    (folder / "found_package" / "inside.py").write_text(MODULE.format(imports=""))
    path = list(sys.path)
    assert NAVIGATORS.load("found_here:Mine").__name__ == "Mine"
    assert NAVIGATORS.load("found_here:Mine.Nested").__name__ == "Nested"
    assert NAVIGATORS.load("found_package.inside:Mine").__name__ == "Mine"
    assert sys.path == path


def test_a_file_here_replaces_no_module_that_is_installed(folder):
    (folder / "string.py").write_text(MODULE.format(imports=""))
    (folder / "torch.py").write_text("raise RuntimeError\n")
    (folder / "uses_string.py").write_text(MODULE.format(imports="import string; string.digits"))
    NAVIGATORS.load("uses_string:Mine")
    with pytest.raises(BrokenPluginError, match=r"string.py is not read, because an installed"):
        NAVIGATORS.load("string:Mine")


@pytest.mark.parametrize(
    ("name", "cause"),
    [
        ("nowhere_here:Mine", "Start benchnav in the folder of nowhere_here.py"),
        ("spelt_herr:Mine", "Did you mean 'spelt_here'"),
        ("spelt_here:Mime", "has no 'Mime'. Did you mean 'Mine'"),
        ("spelt_here.py:Mine", "without folder and ending: spelt_here:Mine"),
        ("./spelt_here:Mine", "without folder and ending: spelt_here:Mine"),
        ("sub/spelt_here.py:Mine", "without folder and ending: spelt_here:Mine"),
        ("spelt_here:", "must be a plugin name, or module:Class"),
        (":Mine", "must be a plugin name, or module:Class"),
        ("needs_more:Mine", "No module named 'not_there_at_all'"),
        ("leaves:Mine", "SystemExit: 3"),
        ("broken_syntax:Mine", r"SyntaxError: .*broken_syntax.py, line 1"),
        ("json:loads", "must be a class derived from"),
    ],
)
def test_what_is_not_found_is_told_with_its_cure(folder, name, cause):
    (folder / "spelt_here.py").write_text(MODULE.format(imports=""))
    (folder / "needs_more.py").write_text("import not_there_at_all\n")
    (folder / "leaves.py").write_text("raise SystemExit(3)\n")
    (folder / "broken_syntax.py").write_text("def (:\n")
    with pytest.raises(BrokenPluginError, match=cause):
        NAVIGATORS.load(name)
