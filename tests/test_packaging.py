"""pyproject.toml says what the folders are, and layers import downwards only."""

import ast
import csv
import subprocess
import sys
import sysconfig
import tomllib
import venv
from importlib import import_module
from pathlib import Path
from zipfile import ZipFile

import pytest

import benchnav
from benchnav.metrics.metric import metrics_in

ROOT = Path(benchnav.__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
FOLDERS = PROJECT["tool"]["setuptools"]["package-dir"]
LAYERS = [
    {name.strip().removeprefix("benchnav.") for name in layer.split("|")}
    for layer in PROJECT["tool"]["importlinter"]["contracts"][0]["layers"]
]
HEIGHT = {name: -place for place, layer in enumerate(LAYERS) for name in layer}
SOURCES = sorted((ROOT / "benchnav").rglob("*.py"))


def packages():
    for package, folder in FOLDERS.items():
        yield package
        for init in sorted((ROOT / folder).rglob("*/__init__.py")):
            yield ".".join([package, *init.parent.relative_to(ROOT / folder).parts])


def imports(source):
    """Names of benchnav modules that a file imports anywhere, lazily too."""
    for node in ast.walk(ast.parse(source.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.level == 0 and node.module:
            yield node.module


def test_the_packages_list_equals_the_folders():
    assert sorted(PROJECT["tool"]["setuptools"]["packages"]) == sorted(packages())


def test_every_folder_with_code_is_a_package():
    for folder in FOLDERS.values():
        for source in (ROOT / folder).rglob("*.py"):
            assert (source.parent / "__init__.py").exists(), source


@pytest.mark.parametrize(
    "value",
    sorted({v for group in PROJECT["project"]["entry-points"].values() for v in group.values()}),
)
def test_entry_points_lead_somewhere(value):
    module, _, name = value.partition(":")
    package, _, rest = module.partition(".")
    folder = ROOT / FOLDERS[package] / Path(*rest.split("."))
    if not name:  # a module of metrics, or a package of YAML files
        found = folder.with_suffix(".py").exists() or list(folder.glob("**/*.yaml"))
        assert found, value
        return
    source = (
        folder.with_suffix(".py") if folder.with_suffix(".py").exists() else folder / "__init__.py"
    )
    names = {
        getattr(node, "name", None) or ast.unparse(node.targets[0])
        for node in ast.parse(source.read_text(encoding="utf-8")).body
        if isinstance(node, ast.ClassDef | ast.FunctionDef | ast.Assign)
    }
    if name:
        assert name in names or hasattr(import_module(module), name)
    else:  # a module stands for all metrics that it defines
        assert metrics_in(import_module(module))


@pytest.fixture(scope="module")
def editable(tmp_path_factory):
    """The Python of an environment that holds nothing but the editable install."""
    folder = tmp_path_factory.mktemp("editable")
    build = f"from setuptools.build_meta import build_editable; build_editable({str(folder)!r})"
    subprocess.run([sys.executable, "-c", build], cwd=ROOT, check=True, capture_output=True)
    venv.create(folder / "env", symlinks=True)
    site = sysconfig.get_path("purelib", vars={"base": str(folder / "env")})
    with ZipFile(next(folder.glob("*.whl"))) as wheel:
        wheel.extractall(site)
    return folder / "env" / "bin" / "python", Path(site)


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(FOLDERS))
def test_the_editable_install_wins_over_a_folder_of_its_name(editable, tmp_path, name):
    python, _ = editable
    (tmp_path / "benchnav").symlink_to(ROOT)
    (tmp_path / "benchnav_baselines").mkdir()
    code = f"import {name}; print({name}.__file__)"
    for options in ((), ("-P",)):
        done = subprocess.run(
            [python, *options, "-c", code], cwd=tmp_path, check=True, capture_output=True, text=True
        )
        assert Path(done.stdout.strip()) == ROOT / FOLDERS[name] / "__init__.py"
        assert done.stderr == ""


@pytest.mark.slow
def test_the_record_of_the_editable_install_is_right(editable):
    _, site = editable
    (record,) = site.glob("benchnav-*.dist-info/RECORD")
    rows = list(csv.reader(record.read_text().splitlines()))
    (size,) = (int(row[2]) for row in rows if row[0].endswith(".pth"))
    (pth,) = site.glob("*.pth")
    assert size == pth.stat().st_size


def test_versions_agree():
    assert PROJECT["project"]["version"] == benchnav.__version__
    assert f"version: {benchnav.__version__}" in (ROOT / "CITATION.cff").read_text(encoding="utf-8")


def test_the_licence_is_complete():
    text = (ROOT / "LICENSE").read_text(encoding="utf-8")
    assert text.lstrip().startswith("Apache License\n                           Version 2.0")
    assert "END OF TERMS AND CONDITIONS" in text
    assert PROJECT["project"]["license"] == "Apache-2.0"


@pytest.mark.parametrize("folder", ["baselines", "robots", "scenarios"])
def test_a_folder_is_not_importable_under_its_own_name(folder):
    namespace = {"__name__": folder}
    code = (ROOT / folder / "__init__.py").read_text(encoding="utf-8")
    with pytest.raises(ImportError, match=f"Import benchnav_{folder}"):
        exec(compile(code, folder, "exec"), namespace)


@pytest.mark.parametrize("source", [pytest.param(s, id=str(s.relative_to(ROOT))) for s in SOURCES])
def test_modules_import_downwards_only(source):
    parts = source.relative_to(ROOT / "benchnav").with_suffix("").parts
    own = parts[0]
    for name in imports(source):
        root, _, rest = name.partition(".")
        assert root not in ("benchnav_baselines", "benchnav_robots", "benchnav_scenarios")
        if root != "benchnav" or own in ("__init__", "__main__") or not rest:
            continue
        other = rest.partition(".")[0]
        assert other == own or HEIGHT[other] < HEIGHT[own], f"{source.name} imports {name}"


def test_contributors_are_told_the_layers():
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    told = text.split("```text\n")[1].split("```")[0].splitlines()
    assert [{name.strip() for name in line.split("|")} for line in told] == LAYERS


def test_baselines_and_scenarios_import_their_own_relatively():
    for folder in ("baselines", "scenarios"):
        for source in (ROOT / folder).rglob("*.py"):
            assert not any(name.startswith(f"benchnav_{folder}") for name in imports(source)), (
                source
            )


def test_nobody_suppresses_warnings_wholesale():
    assert PROJECT["tool"]["pytest"]["ini_options"]["filterwarnings"][0] == "error"
