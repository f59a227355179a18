"""A navigator that misbehaves when it is asked who it is costs itself, and nothing else."""

from textwrap import indent

import pytest

from benchnav.arena.sensing import Sensing
from benchnav.errors import BrokenPluginError
from benchnav.navigation.plugin import plugin_process
from benchnav.navigation.plugin.capabilities import Capabilities
from benchnav.navigation.plugin.guarded_capabilities import read_guarded_capabilities
from benchnav.processes.fork_server import fork_server

HEAD = """
import ctypes, os, signal, sys, threading, time
from pydantic import field_validator
from benchnav_baselines.navigators.straight_line import StraightLine

class Silent(Exception):
    def __str__(self):
        raise KeyboardInterrupt

class Endless(Exception):
    def __str__(self):
        time.sleep(1e6)

class Good(StraightLine):
    pass
"""
MISDEEDS = {
    "hangs": ("time.sleep(1e6)", "did not return from"),
    "spins": ("while True: pass", "did not return from"),
    "stops": ("os.kill(os.getpid(), signal.SIGSTOP)", "did not return from"),
    "exits": ("sys.exit(0)", "SystemExit"),
    "leaves": ("os._exit(0)", "ended with exit status 0"),
    "is killed": ("os.kill(os.getpid(), signal.SIGKILL)", "was killed by SIGKILL"),
    "crashes": ("ctypes.string_at(0)", "was killed by SIGSEGV"),
    "interrupts": ("raise KeyboardInterrupt", "KeyboardInterrupt"),
    "says nothing": ("raise Silent", "Silent"),
    "says endlessly": ("raise Endless", "did not return from"),
    "says too much": ("raise ValueError('\\\\x1b[2J\\\\udc80' + 'x' * 30_000_000)", "ValueError"),
    "recurses": ("def f(): f()\nf()", "RecursionError"),
    "kills its parent": (
        "os.kill(os.getppid(), 9)\ntime.sleep(1e6)",
        "ended the process that had started it",
    ),
    "closes all": ("os.closerange(3, 1000)\ntime.sleep(1e6)", "closed its channel"),
    "writes garbage": (
        "for i in range(3, 60):\n    try: os.write(i, b'\\\\x80garbage')\n"
        "    except OSError: pass\n"
        "os._exit(0)", "",
    ),
}  # fmt: skip
PLACES = {
    "__init__": "class C{k}(StraightLine):\n    def __init__(self, config=None):\n{misdeed}\n",
    "Config": "class C{k}(StraightLine):\n    class Config(StraightLine.Config):\n"
    "        def __init__(self, **given):\n{misdeed}\n",
    "required": "class C{k}(StraightLine):\n    @property\n    def required(self):\n{misdeed}\n",
}
LIES = {
    "reproducible": ("'yes'", "its reproducible must be true or false. Got 'yes' instead"),
    "uses_map": ("1", "its uses_map must be"),
    "required": ("'rays'", "its required"),
    "command": ("'teleport'", "its command must be 'velocity' or 'twist'"),
    "drives": ("frozenset({'bike'})", "its drives"),
    "rehearsal": ("-1", "its rehearsal must be ≥ 0"),
    "leader": ("object()", "its leader"),
    "training": ("object()", "its training must be"),
    "fingerprint": ("5", "its fingerprint"),
    "parts": ("5", "its parts"),
    "unfit": ("5", "its unfit"),
}
SENSINGS = [Sensing(None, None, None)]


@pytest.fixture(autouse=True)
def short(monkeypatch):
    monkeypatch.setattr(plugin_process, "_IMPORTING", 2.0)


def asked(folder, monkeypatch, modules, specs, timeout=1.0):
    for name, code in modules.items():
        (folder / f"{name}.py").write_text(HEAD + code)
    monkeypatch.syspath_prepend(folder)
    fork_server()  # its start does not count
    return read_guarded_capabilities([(spec, "here") for spec in specs], SENSINGS, timeout)


def is_broken(answer, spec, cause):
    text = str(answer)
    assert isinstance(answer, BrokenPluginError), (spec, answer)
    assert repr(spec) in text
    assert cause in text
    assert len(text) < 1000
    assert "\x1b" not in text
    text.encode()
    return True


SLOW = [pytest.param(place, marks=pytest.mark.slow) for place in ("Config", "required", "import")]


@pytest.mark.parametrize("place", ["__init__", *SLOW])
def test_what_misbehaves_is_broken_and_the_others_are_met(place, tmp_path, monkeypatch):
    modules, specs = {}, []
    for k, (misdeed, _) in enumerate(MISDEEDS.values()):
        if place == "import":
            modules[f"hostile{k}"] = misdeed
            specs.append(f"hostile{k}:C")
        else:
            code = PLACES[place].replace("{k}", str(k))
            code = code.replace("{misdeed}", indent(misdeed, " " * 12))
            modules["hostile"] = modules.get("hostile", "") + code
            specs.append(f"hostile:C{k}")
    modules["good"] = ""
    *answers, good, orca = asked(tmp_path, monkeypatch, modules, [*specs, "good:Good", "orca"])
    assert isinstance(good, Capabilities)
    assert isinstance(orca, Capabilities)
    for spec, answer, (_, cause) in zip(specs, answers, MISDEEDS.values(), strict=True):
        assert is_broken(answer, spec, cause)


def test_a_lie_is_named(tmp_path, monkeypatch):
    code = "".join(
        f"class {name.title()}(StraightLine):\n    {name} = property(lambda self: {value})\n"
        for name, (value, _) in LIES.items()
    )
    specs = [f"lying:{name.title()}" for name in LIES]
    answers = asked(tmp_path, monkeypatch, {"lying": code}, specs)
    for spec, answer, (_, cause) in zip(specs, answers, LIES.values(), strict=True):
        assert is_broken(answer, spec, cause)


def test_an_import_has_more_time_than_a_call(tmp_path, monkeypatch):
    (answer,) = asked(tmp_path, monkeypatch, {"slow": "time.sleep(0.5)"}, ["slow:Good"], 0.2)
    assert isinstance(answer, Capabilities)


def test_what_a_plugin_prints_never_reaches_stdout(tmp_path, monkeypatch, capfd):
    code = "print('printed')\nos.write(1, b'written')"
    (answer,) = asked(tmp_path, monkeypatch, {"loud": code}, ["loud:Good"])
    assert isinstance(answer, Capabilities)
    assert capfd.readouterr().out == ""
