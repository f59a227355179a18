"""The package that `benchnav new` writes is complete, and the tutorial shows it."""

import os
import subprocess
import sys
import tomllib

import pytest

import benchnav
from benchnav.api.authoring.new_package import KINDS
from benchnav.api.authoring.plugin_templates import navigator_package
from benchnav.cli.main import status
from benchnav.errors import UsageError
from tests.docs.blocks import NAMED, ROOT, blocks


def test_it_writes_a_src_layout_with_test_and_readme(tmp_path, capfd):
    target = tmp_path / "my-bot"
    assert status(["new", "navigator", "my-bot", "--out", str(target)]) == 0
    written = {str(p.relative_to(target)) for p in target.rglob("*") if p.is_file()}
    assert written == {"pyproject.toml", "README.md", "src/my_bot.py", "tests/test_my_bot.py"}
    project = tomllib.loads((target / "pyproject.toml").read_text())
    assert project["project"]["entry-points"]["benchnav.navigators"] == {"my-bot": "my_bot:MyBot"}
    out, err = capfd.readouterr()
    assert out == f"{target}\n"
    assert "pytest" in err


def test_the_tutorial_shows_these_files():
    shown = {}
    for block in blocks(ROOT / "docs" / "navigators.md"):
        named = NAMED.match(block.text)
        if named:
            path = named["name"].removeprefix("keep-away/")
            shown.setdefault(path, block.text.removeprefix(named[0]))
    package = navigator_package("keep-away")
    for path in ("pyproject.toml", "src/keep_away.py", "tests/test_keep_away.py"):
        assert shown[path] == package[path], path


@pytest.fixture(scope="module")
def packages(tmp_path_factory):
    """A folder with one package of each kind, and a folder in which they are installed."""
    folder = tmp_path_factory.mktemp("new")
    sources = []
    for kind in KINDS:
        source = folder / f"keen-{kind}"
        assert status(["new", kind, source.name, "--out", str(source)]) == 0
        sources.append(source)
    pip = [sys.executable, "-m", "pip", "--disable-pip-version-check", "install", "--quiet"]
    offline = ["--no-index", "--no-deps", "--no-build-isolation", "--target"]
    command = [*pip, *offline, folder / "site", *sources]
    subprocess.run(command, check=True, timeout=300)
    return folder


@pytest.mark.slow
def test_the_test_of_each_kind_passes_untouched(packages):
    inherited = os.environ.get("PYTHONPATH", "")
    path = os.pathsep.join([str(packages / "site"), *([inherited] if inherited else [])])
    tests = [str(file) for file in sorted(packages.glob("keen-*/tests/*.py"))]
    assert len(tests) == len(KINDS) == 5
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-W", "error", *tests],
        cwd=packages, env={**os.environ, "PYTHONPATH": path}, capture_output=True, text=True,
        timeout=300, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    assert "6 passed" in done.stdout  # a scenario and a suite in the pack


@pytest.mark.parametrize(
    ("kind", "name", "text"),
    [
        ("planner", "navmesh", "'navmesh' is a planner of"),
        ("controller", "orca", "'orca' is a controller of"),
        ("metric", "path-length", "'path_length' is a metric of"),
        ("scenario-pack", "benchnav", "'benchnav' is a"),
        ("planner", "Bad Name", "must be small letters"),
    ],
)
def test_a_name_that_is_taken_is_refused(kind, name, text, tmp_path, capfd):
    assert status(["new", kind, name, "--out", str(tmp_path / "x")]) == 2
    assert text in capfd.readouterr().err
    with pytest.raises(UsageError, match=r"must be one of navigator, .*Did you mean 'planner'"):
        benchnav.new_package("planer", "mine", tmp_path / "x")
