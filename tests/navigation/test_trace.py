"""Where a plugin failed is told by file and line, whatever its exceptions do."""

import sys
from pathlib import Path

import numpy as np
import pytest

from benchnav.errors import BrokenPluginError
from benchnav.navigation.command_check import (
    exception_text,
    grouped,
    kind_of,
    one_of_each_kind,
    short,
)
from benchnav.navigation.plugin.trace import MOST, bounded, location, plain, trace

PLUGIN = """
import json
from helping import help_out

def direct():
    raise ValueError("no")

def through_a_library():
    json.loads("{")

def through_a_file_beside():
    help_out()

def deep(n=0):
    return deep(n + 1)

def chained():
    try:
        {}["x"]
    except KeyError as error:
        raise RuntimeError("lost") from error
"""


@pytest.fixture
def plugin(tmp_path, monkeypatch):
    (tmp_path / "fragile.py").write_text(PLUGIN)
    (tmp_path / "helping.py").write_text("def help_out():\n    return 1 / 0\n")
    monkeypatch.syspath_prepend(tmp_path)
    import fragile

    yield fragile
    for name in ("fragile", "helping"):
        sys.modules.pop(name, None)


def raised(call, *arguments):
    try:
        call(*arguments)
    except BaseException as error:
        return error
    raise AssertionError("nothing was raised")


def test_the_innermost_line_of_the_plugins_own_code_is_told(plugin):
    assert location(raised(plugin.direct)) == "fragile.py:6"
    assert location(raised(plugin.through_a_library)) == "fragile.py:9"
    assert location(raised(plugin.through_a_file_beside)) == "helping.py:2"
    assert exception_text(raised(plugin.direct)) == "ValueError: no (fragile.py:6)"


def test_a_module_of_a_package_is_told_with_its_package():
    error = raised(np.linalg.inv, np.zeros((2, 2)))
    assert location(error.with_traceback(None)) == ""
    assert location(raised(lambda: 1 / 0)).startswith("tests/navigation/test_trace.py:")


def test_a_traceback_shows_no_folder_of_this_machine(plugin, tmp_path):
    text = trace(raised(plugin.through_a_library))
    assert str(tmp_path) not in text
    assert sys.prefix not in text
    assert '  File "fragile.py", line 9, in through_a_library\n    json.loads("{")' in text
    assert '  File "json/decoder.py", line ' in text
    assert text.endswith(": line 1 column 2 (char 1)")


def test_the_home_folder_is_not_told(monkeypatch):
    monkeypatch.setenv("HOME", "/home/ada")
    assert short("no file /home/ada/weights.pt") == "no file ~/weights.pt"


def test_what_led_to_an_exception_is_told_first(plugin):
    text = trace(raised(plugin.chained))
    assert text.index("KeyError: 'x'") < text.index("RuntimeError: lost")
    broken = BrokenPluginError("cannot be made")
    broken.__cause__ = raised(plugin.direct)
    assert trace(broken) == trace(broken.__cause__)


def test_a_deep_stack_and_a_long_message_are_cut(plugin):
    text = trace(raised(plugin.deep))
    assert "more calls" in text
    assert text.splitlines()[-1].startswith("RecursionError: maximum recursion")
    assert len(text) < MOST
    assert len(trace(ValueError("x" * 10_000_000))) < MOST
    assert len(bounded("y\n" * 1_000_000)) <= MOST
    assert len(exception_text(ValueError("x" * 10_000_000))) < 400


class Raising(Exception):
    def __str__(self):
        raise RuntimeError("ha")


class Leaving(Exception):
    def __str__(self):
        raise SystemExit


class Nothing(Exception):
    def __str__(self):
        return None


class Odd(str):
    def __getitem__(self, key):
        raise RuntimeError

    def __str__(self):
        return self

    def split(self, *arguments):
        raise RuntimeError


class Subclass(Exception):
    def __str__(self):
        return Odd("odd")


class Meta(type):
    @property
    def __name__(cls):
        raise RuntimeError


class Nameless(Exception, metaclass=Meta):
    @property
    def __traceback__(self):
        raise RuntimeError

    @property
    def __cause__(self):
        raise RuntimeError


@pytest.mark.parametrize(
    "error",
    [
        Raising(), Leaving(), Nothing(), Subclass(), Nameless("x"), ValueError("\udcff\x1b[31m\0"),
        KeyError(Odd("a")), ValueError(*range(10)), ExceptionGroup("g", [ValueError("a")]),
    ],
    ids=lambda error: type.__dict__["__name__"].__get__(type(error)),
)  # fmt: skip
def test_a_hostile_exception_becomes_text_that_can_be_stored(error):
    def fail():
        raise error

    error = raised(fail)
    for text in (exception_text(error), short(error), plain(error), trace(error)):
        assert type(text) is str
        text.encode("utf-8")
        assert not any(ord(c) < 32 and c not in "\n\t" for c in text)
    assert exception_text(error).split(":")[0].isidentifier()


def test_a_folder_of_a_notebook_is_not_told():
    scope = {"__name__": "__main__"}
    path = str(Path("tmp") / "ipykernel_4242" / "1234.py")
    exec(compile("def f():\n    1 / 0\n", path, "exec"), scope)
    assert location(raised(scope["f"])) == "<notebook>:2"


def test_reasons_of_one_fault_are_one_group():
    reasons = {
        "act raised IndexError: index 5 is out (a.py:3) at t = 0.4 s": 2,
        "act raised IndexError: index 7 is out (a.py:3) at t = 1e+02 s": 3,
        "act raised IndexError: index 7 is out (a.py:9) at t = 1 s": 1,
        "act raised KeyError: 7 (a.py:3) at t = 1 s": 1,
        "the planner found no path: a grid of 0.25 m is too large": 1,
        "the planner found no path: a grid of 0.5 m is too large": 1,
    }
    assert grouped(reasons) == [
        ("act raised IndexError: index 7 is out (a.py:3)", 5),
        ("the planner found no path: a grid of 0.25 m is too large", 2),
        ("act raised IndexError: index 7 is out (a.py:9)", 1),
        ("act raised KeyError: 7 (a.py:3)", 1),
    ]
    assert kind_of("ValueError: 3 (a.py:3)") == kind_of("ValueError: 4 (a.py:3)")


def test_a_reason_and_its_times_are_one_kind():
    reasons = ["no path at t = 0.4 s", "no path", "no path at t = 3 s", "lost"]
    assert one_of_each_kind(reasons) == ["no path at t = 0.4 s", "lost"]
