"""The source hash of modules on disk: what counts, what does not, and that nothing is imported."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from benchnav.source.closure import Closure
from benchnav.source.digest import source_hash
from benchnav.source.module import locate
from benchnav.source.parts import places_of


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder that modules are imported from."""
    monkeypatch.syspath_prepend(str(tmp_path))
    return tmp_path


def write(folder, **files):
    for name, text in files.items():
        path = folder / name.replace("__", "/")
        path = path.with_suffix(".py") if not path.suffix else path
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)


def test_an_edit_changes_the_hash_and_undoing_it_restores_it(folder):
    write(folder, only_module="class A: gain = 1\n")
    before = source_hash(["only_module:A"])
    write(folder, only_module="class A: gain = 2\n")
    assert source_hash(["only_module:A"]) != before
    write(folder, only_module="class A: gain = 1\n")
    assert source_hash(["only_module:A"]) == before
    assert "only_module" not in sys.modules


def test_line_endings_are_content(folder):
    (folder / "ending.py").write_bytes(b"class A: gain = 1\n")
    before = source_hash(["ending:A"])
    (folder / "ending.py").write_bytes(b"class A: gain = 1\r\n")
    assert source_hash(["ending:A"]) != before


@pytest.mark.parametrize(
    "statement",
    [
        "import helper_of_mine",
        "from helper_of_mine import gain",
        "def later():\n    import helper_of_mine as h\n    return h",
        "try:\n    from helper_of_mine import gain\nexcept ImportError:\n    gain = 1",
        "from importlib import import_module\nhelper = import_module('helper_of_mine')",
    ],
)
def test_helpers_count_however_they_are_imported(folder, statement):
    write(folder, with_helper=statement + "\n", helper_of_mine="gain = 1\n")
    before = source_hash(["with_helper:A"])
    write(folder, helper_of_mine="gain = 2\n")
    assert source_hash(["with_helper:A"]) != before


def test_what_is_beside_a_module_and_not_of_it_does_not_count(folder):
    write(folder, alone="import json\n", other="x = 1\n")
    before = source_hash(["alone:A"])
    write(folder, other="x = 2\n")
    (folder / "notes.txt").write_text("tomorrow")
    (folder / "table.csv").write_text("1,2")
    (folder / "runs").mkdir()
    assert source_hash(["alone:A"]) == before


def package(folder, name="a_package"):
    home = folder / name
    (home / "inner").mkdir(parents=True)
    (home / "__init__.py").write_text("")
    (home / "inner" / "__init__.py").write_text("")
    (home / "nav.py").write_text("from .inner.deep import gain\nfrom . import tools\n")
    (home / "inner" / "deep.py").write_text("from ..base import gain\n")
    (home / "base.py").write_text("gain = 1\n")
    (home / "tools.py").write_text("def tool(): ...\n")
    (home / "unused.py").write_text("x = 1\n")
    (home / "weights").mkdir()
    (home / "weights" / "best.bin").write_bytes(b"\0\1")
    return home


@pytest.mark.parametrize(
    "changed",
    ["nav.py", "inner/deep.py", "base.py", "tools.py", "__init__.py", "inner/__init__.py",
     "weights/best.bin", "table.yaml"],
)  # fmt: skip
def test_what_counts_of_a_package(folder, changed):
    home = package(folder)
    before = source_hash(["a_package.nav:A"])
    (home / changed).write_text("# edited\n")
    assert source_hash(["a_package.nav:A"]) != before
    assert not [name for name in sys.modules if name.startswith("a_package")]


@pytest.mark.parametrize(
    "added",
    ["unused.py", "tests/test_it.py", "tests/data.bin", "__pycache__/nav.cpython-311.pyc",
     ".git/index", ".venv/pyvenv.cfg", "README.md", "nav.pyi", "inner/.hidden",
     "node_modules/x.js"],
)  # fmt: skip
def test_what_does_not_count_of_a_package(folder, added):
    home = package(folder)
    before = source_hash(["a_package.nav:A"])
    (home / added).parent.mkdir(parents=True, exist_ok=True)
    (home / added).write_text("# something else\n")
    assert source_hash(["a_package.nav:A"]) == before


def test_a_virtual_environment_and_a_run_within_a_package_do_not_count(folder):
    home = package(folder)
    before = source_hash(["a_package.nav:A"])
    for name in ("environment/lib/x.bin", "runs/r/parts/cell/000000-000002.seal.json"):
        (home / name).parent.mkdir(parents=True, exist_ok=True)
        (home / name).write_text("x")
    (home / "environment" / "pyvenv.cfg").write_text("home = /usr")
    (home / "runs" / "r" / "manifest.json").write_text("{}")
    assert source_hash(["a_package.nav:A"]) == before


def test_modules_that_are_imported_by_computed_names_count_all(folder):
    home = package(folder)
    (home / "nav.py").write_text("import importlib\nx = importlib.import_module(f'.{1}', 'p')\n")
    before = source_hash(["a_package.nav:A"])
    (home / "unused.py").write_text("x = 2\n")
    assert source_hash(["a_package.nav:A"]) != before


@pytest.mark.parametrize(
    ("code", "file"),
    [
        ("W = open('weights.bin')", "weights.bin"),
        ("W = Path(__file__).parent / 'data' / 'v2' / 'w.npz'", "data/v2/w.npz"),
        ("W = os.path.join(HERE, 'data', 'w.npz')", "data/w.npz"),
        ("W = HERE / f'data/{name}.npz'", "data/best.npz"),
        ("W = HERE.glob('*.npz')", "best.npz"),
        ("exec(open('code.py').read())", "code.py"),
    ],
)
def test_data_that_a_module_names_counts(folder, code, file):
    write(folder, reader=code + "\n")
    (folder / file).parent.mkdir(parents=True, exist_ok=True)
    (folder / file).write_text("1")
    before = source_hash(["reader:A"])
    (folder / file).write_text("2")
    assert source_hash(["reader:A"]) != before


def test_the_hash_is_the_same_in_another_folder_and_process(folder, tmp_path_factory):
    package(folder)
    other = tmp_path_factory.mktemp("other")
    package(other)
    script = (
        "from benchnav.source.digest import source_hash; print(source_hash(['a_package.nav:A']))"
    )
    found = subprocess.run(
        [sys.executable, "-c", script], check=True, capture_output=True, text=True, cwd=other,
        env={**os.environ, "PYTHONPATH": str(other)},
    )  # fmt: skip
    assert found.stdout.strip() == source_hash(["a_package.nav:A"])


def install(site, name, code):
    """As pip leaves it: files, and what its distribution says it brought."""
    info = site / f"{name}-1.0.dist-info"
    info.mkdir(parents=True)
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n")
    (site / f"{name}.py").write_text(code)
    (site / f"{name}_shared.py").write_text("x = 1\n")
    record = "".join(f"{n},,\n" for n in (f"{name}.py", f"{name}_shared.py"))
    (info / "RECORD").write_text(record)


def test_of_installed_code_the_distribution_counts_and_its_dependencies_do_not(
    tmp_path, monkeypatch
):
    site = tmp_path / "site-packages"
    install(site, "dependency", "x = 1\n")
    install(site, "plugin_of_mine", "import dependency\nfrom plugin_of_mine_shared import x\n")
    monkeypatch.syspath_prepend(str(site))
    before = source_hash(["plugin_of_mine:A"])
    (site / "dependency.py").write_text("x = 2\n")
    assert source_hash(["plugin_of_mine:A"]) == before
    (site / "plugin_of_mine_shared.py").write_text("x = 2\n")
    assert source_hash(["plugin_of_mine:A"]) != before


def closure_of(spec):
    closure = Closure()
    closure.add([place.partition(":")[0] for place in places_of(spec)])
    return {name.removeprefix("benchnav_baselines").lstrip(".") for name in closure.modules}


def test_what_ships_is_told_apart():
    orca = closure_of({"type": "orca"})
    assert {"controllers.orca.kernel", "controllers.orca.navigator"} <= orca
    straight = closure_of({"type": "straight-line"})
    assert not any(".orca" in name for name in straight)
    pair = {"type": "hierarchical", "planner": {"type": "navmesh"}, "controller": {"type": "dwa"}}
    assert {"planners.navmesh.taut_search", "controllers.dwa.kernel"} <= closure_of(pair)
    assert "learned.recurrent_ppo.actor" in closure_of({"type": "map-orca-ppo"})
    assert not any(name.startswith("benchnav.") for name in closure_of(pair))


def test_the_simulator_is_its_versions_business():
    assert closure_of({"type": "benchnav.navigation.hierarchy.hierarchical:Hierarchical"}) == set()


@pytest.mark.parametrize("command", [["{file}"], ["python3", "{file}"], ["sh", "{file}", "--fast"]])
def test_the_file_of_a_program_counts(tmp_path, command):
    file = tmp_path / "navigate.py"
    file.write_text("import helper_of_program\n")
    file.chmod(0o755)
    (tmp_path / "helper_of_program.py").write_text("x = 1\n")
    spec = {"type": "process", "command": [part.format(file=file) for part in command]}

    def found():
        return source_hash(places_of(spec), [spec])

    first = found()
    (tmp_path / "helper_of_program.py").write_text("x = 2\n")
    second = found()
    file.write_text("import helper_of_program as h\n")
    assert len({first, second, found()}) == 3


def test_a_program_on_the_path_and_a_module_that_python_runs_count(folder, monkeypatch):
    program = folder / "my-navigator"
    program.write_text("#!/bin/sh\n")
    program.chmod(0o755)
    monkeypatch.setenv("PATH", f"{folder}:{os.environ['PATH']}")
    package(folder)
    for command, edited in (
        (["my-navigator"], program),
        (["python3", "-m", "a_package.nav"], folder / "a_package" / "base.py"),
    ):
        spec = {"type": "process", "command": command}
        before = source_hash(places_of(spec), [spec])
        edited.write_text("#!/bin/sh\n# edited\n")
        assert source_hash(places_of(spec), [spec]) != before


def test_files_that_parameters_name_count(tmp_path):
    weights, folder = tmp_path / "best.npz", tmp_path / "checkpoint"
    weights.write_text("1")
    folder.mkdir()
    (folder / "part").write_text("1")
    spec = {"type": "x", "weights": str(weights), "more": {"from": [str(folder)]}, "speed": 1.0}
    first = source_hash((), [spec])
    weights.write_text("2")
    second = source_hash((), [spec])
    (folder / "part").write_text("2")
    assert len({first, second, source_hash((), [spec])}) == 3


def test_a_folder_as_large_as_a_home_is_not_read(folder, monkeypatch):
    write(folder, at_home="x = 'documents'\n")
    (folder / "documents").mkdir()
    for i in range(50):
        (folder / "documents" / f"{i}.bin").write_bytes(bytes(10))
    read = []
    genuine = Path.open
    monkeypatch.setattr(Path, "open", lambda p, *a, **k: read.append(p) or genuine(p, *a, **k))
    source_hash(["at_home:A"])
    assert {path.name for path in read} <= {"at_home.py"}


def test_a_module_is_located_without_importing_its_package(folder):
    home = package(folder)
    (home / "__init__.py").write_text("raise RuntimeError('imported')\n")
    found = locate("a_package.inner.deep")
    assert (found.file, found.package, found.root) == (
        home / "inner" / "deep.py", "a_package.inner", folder,
    )  # fmt: skip
    assert locate("a_package.nothing") is None
    assert locate("nothing_of_that_name") is None
    assert locate("sys") is None
