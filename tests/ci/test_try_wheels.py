"""The trial of the wheel: which Pythons it takes, what it pins, and what it calls a failure."""

import sys
import tomllib
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from zipfile import ZipFile

import pytest

ROOT = Path(__file__).parents[2]
VERSION = f"{sys.version_info.major}.{sys.version_info.minor}"


@pytest.fixture
def trial(monkeypatch):
    spec = spec_from_file_location("try_wheels", ROOT / ".ci" / "try_wheels.py")
    module = module_from_spec(spec)
    monkeypatch.setitem(sys.modules, "try_wheels", module)
    spec.loader.exec_module(module)
    return module


def test_newest_and_lowest_dependencies_are_tried_and_a_training_on_one(trial):
    assert [t.python for t in trial.TRIALS] == ["3.11", "3.12", "3.13"]
    assert {t.lowest for t in trial.TRIALS} == {True, False}
    assert any("learn" in t.extras for t in trial.TRIALS)


@pytest.mark.parametrize("found", [0, 1])
def test_fewer_than_two_pythons_fail(trial, monkeypatch, capsys, found):
    given = {t.python: Path(sys.executable) for t in trial.TRIALS[:found]}
    monkeypatch.setattr(trial, "interpreter", given.get)
    monkeypatch.setattr(trial, "build", lambda folder: pytest.fail("nothing is to be built"))
    with pytest.raises(SystemExit, match="tried on two Pythons at least"):
        trial.main()
    assert capsys.readouterr().out.count("no such Python was found") == 3 - found


def test_an_interpreter_is_found_on_the_path_or_among_those_of_pyenv(trial, monkeypatch, tmp_path):
    monkeypatch.setattr(trial, "which", lambda name: None)
    for place in ("path", f"pyenv/versions/{VERSION}.99/bin"):
        (tmp_path / place).mkdir(parents=True)
    monkeypatch.setenv("PATH", str(tmp_path / "path"))
    monkeypatch.setenv("PYENV_ROOT", str(tmp_path / "pyenv"))
    broken = tmp_path / "path" / f"python{VERSION}"
    broken.write_text("#!/bin/sh\nexit 127\n")  # as a shim of pyenv without such a version
    broken.chmod(0o755)
    assert trial.interpreter(VERSION) is None
    link = tmp_path / f"pyenv/versions/{VERSION}.99/bin/python{VERSION}"
    link.symlink_to(sys.executable)
    assert trial.interpreter(VERSION) == link
    assert not trial.works(link, "3.99")


def test_the_lowest_versions_are_those_of_the_project(trial, tmp_path):
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    named = [*project["dependencies"]]
    for extra in project["optional-dependencies"].values():
        named += [need for need in extra if not need.startswith("benchnav[")]
    metadata = "".join(f'Requires-Dist: {need}; extra == "x"\n' for need in named)
    with ZipFile(tmp_path / "benchnav.whl", "w") as wheel:
        wheel.writestr("benchnav-0.1.0.dist-info/METADATA", metadata)
    assert trial.floors(tmp_path / "benchnav.whl") == dict(need.split(">=") for need in named)
    assert f"torch=={trial.torch_pin()}\n" in (ROOT / "constraints.txt").read_text()


@pytest.mark.parametrize(
    "code", ["raise SystemExit(1)", "print('x.py:1: DeprecationWarning: old')"]
)
def test_a_command_that_fails_or_warns_fails_the_trial(trial, tmp_path, code):
    with pytest.raises(trial.FailedError, match=r"exit \d"):
        trial.command(tmp_path, sys.executable, "-c", code)
