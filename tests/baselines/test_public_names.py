"""What ships as a plugin is written with public names, as the plugins of others are."""

import ast
from importlib import import_module
from pathlib import Path

import benchnav_baselines
import pytest

ROOT = Path(benchnav_baselines.__file__).parent
PACKAGES = (
    "benchnav", "benchnav.arena", "benchnav.envs", "benchnav.episode", "benchnav.geometry",
    "benchnav.navigation",
)  # fmt: skip
MODULES = ("benchnav.arrays", "benchnav.errors", "benchnav.kernels", "benchnav.threads")
EXCEPTIONS = frozenset({
    # inner parts of benchnav that baselines share with it
    "GuidedConfig", "MappingConfig", "PartSpec", "PathKey", "FieldError", "first_problem",
    "capsule_grid", "pop", "push", "probability", "SIMPLIFY", "THIN", "section", "locked",
    "read_file", "granted", "read_yaml", "validate",
    # what trainers need of a scenario and of the simulator
    "RANGE", "RAYS", "Simulation", "Trainer", "TrainingReport", "build", "find", "noise_of",
    "ray_angles", "sense", "Tally",
    # processes that learn together
    "end_with_parent", "exit_text", "without_main",
})  # fmt: skip


def imported():
    """(module, name) of everything that baselines import from benchnav."""
    for source in sorted(ROOT.rglob("*.py")):
        for node in ast.walk(ast.parse(source.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and node.level == 0:
                module = node.module or ""
                if module.partition(".")[0] == "benchnav":
                    yield from ((module, alias.name) for alias in node.names)


def is_public(module, name):
    return module in MODULES or (module in PACKAGES and name in import_module(module).__all__)


def test_baselines_use_public_names_only():
    inner = {(module, name) for module, name in imported() if not is_public(module, name)}
    assert {name for _, name in inner} == EXCEPTIONS, sorted(inner)


@pytest.mark.parametrize("package", PACKAGES)
def test_every_public_name_is_there(package):
    found = import_module(package)
    for name in found.__all__:
        assert getattr(found, name) is not None
