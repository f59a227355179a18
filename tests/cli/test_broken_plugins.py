"""No command does nothing, hangs or prints on stdout because of a plugin that is installed."""

import json
import re

import pytest

from benchnav.api.components import inspection
from benchnav.metrics import declared
from benchnav.metrics.measure import own_metrics
from benchnav.navigation.plugin import plugin_process
from benchnav.plugins import NAVIGATORS
from tests.installed import install

MODULES = {
    "exits": "import sys\nprint('loud')\nsys.exit(0)\n",
    "leaves": "import os\nos._exit(0)\n",
    "crashes": "import ctypes\nctypes.string_at(0)\n",
    "hangs": "import time\ntime.sleep(1e6)\n",
}
METRICS = """
import os, time
from dataclasses import replace
import numpy as np
from benchnav.metrics.success import success

def quarter(episode):
    return np.full(len(episode.arrival), 0.25)

good = replace(success, name="good", title="good", rate=False, function=quarter)
dies = replace(success, name="dies", function=lambda e: os._exit(0))
lies = replace(success, name="lies", low="low")
"""


@pytest.fixture(autouse=True)
def short(monkeypatch):
    monkeypatch.setattr(plugin_process, "_IMPORTING", 1.0)
    for module in (inspection, declared):
        monkeypatch.setattr(module, "_TIMEOUT", 1.0)


def installed(monkeypatch, folder, kind):
    install(monkeypatch, folder, METRICS, **{kind: {f"x-{m}": f"{m}:X" for m in MODULES}})
    for name, code in MODULES.items():
        (folder / f"{name}.py").write_text(code)


def test_broken_navigators_are_listed_among_the_others(call, monkeypatch, tmp_path):
    before = NAVIGATORS.names()
    installed(monkeypatch, tmp_path / "site", "navigators")
    code, stdout, _ = call("list", "navigators")
    rows = {line.split()[0]: line.split()[1] for line in stdout.splitlines()}
    assert code == 0
    assert rows == dict.fromkeys(before, "benchnav") | {f"x-{m}": "broken" for m in MODULES}
    code, stdout, _ = call("doctor")
    assert code == 1
    assert stdout.count("WRONG") == len(MODULES)
    assert re.search(rf"navigators +{len(before)} can be used", stdout)


@pytest.mark.parametrize("module", MODULES)
def test_a_broken_plugin_that_is_asked_for_is_refused(call, monkeypatch, tmp_path, suite, module):
    installed(monkeypatch, tmp_path / "site", "navigators")
    for verb in (("show",), ("run", suite, "--timeout", 1, "--out", tmp_path / "o", "--navigator")):
        code, stdout, stderr = call(*verb, f"x-{module}")
        assert (code, stdout) == (2, "")
        assert f"The navigator 'x-{module}' cannot be used: " in stderr
    assert not (tmp_path / "o").exists()


def test_tables_are_shown_without_metrics_that_cannot_be_used(call, monkeypatch, tmp_path, suite):
    code, *_ = call("run", suite, "--out", tmp_path / "run", "--workers", 0, "--quiet")
    assert code == 0
    plain = call("leaderboard", tmp_path / "run")[1]
    installed(monkeypatch, tmp_path / "site", "metrics")
    code, stdout, stderr = call("leaderboard", tmp_path / "run")
    assert (code, stdout) == (0, plain)
    assert all(f"The metric 'x-{module}' cannot be used: " in stderr for module in MODULES)


def test_plugins_measure_again_beside_the_command(call, monkeypatch, tmp_path, suite):
    call("run", suite, "--out", tmp_path / "run", "--workers", 0, "--quiet")
    names = {name: f"hostile:{name}" for name in ("good", "dies", "lies")}
    install(monkeypatch, tmp_path / "site", METRICS, metrics=names)
    arguments = ("--recompute", "--format", "json")
    code, stdout, stderr = call("leaderboard", tmp_path / "run", *arguments)
    assert code == 0
    assert "The metric 'lies' cannot be used: " in stderr
    rows = json.loads(stdout)
    values = {row["metric"]: row["value"] for row in reversed(rows)}  # differences stand last
    assert values["good"] == 0.25
    assert values["dies"] is None
    assert {metric.name for metric in own_metrics()} <= values.keys()
