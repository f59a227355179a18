"""What `import benchnav` promises, and what it must not cost."""

import subprocess
import sys
from types import FunctionType

import pytest

import benchnav
from benchnav import leaderboard, navigation

HEAVY = ("torch", "ompl", "gymnasium", "matplotlib", "ray", "trimesh", "fcl", "pandas", "pedpy",
         "pyarrow", "scipy", "shapely", "numba", "numpy")  # fmt: skip


AUTHORS = {"Navigator", "AgentNavigator", "Controller", "Planner", "Briefing", "Observation",
           "Need", "PluginConfig"}  # fmt: skip


def test_public_names():
    assert set(benchnav.__all__) >= {
        "run", "open_run", "simulate", "load_scenario", "make_env", "merge", "available", "train",
        "show", "validate", "schema", "import_map", "new_navigator", "doctor",
        "Run", "Leaderboard", "Scenario", "World", "Episode", "BenchnavError",
        "register_controller", "register_metric", "register_navigator", "register_planner",
    }  # fmt: skip
    assert set(navigation.__all__) >= AUTHORS
    assert set(benchnav.__all__) <= set(dir(benchnav))


def test_an_unknown_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="module 'benchnav' has no attribute 'rnu'"):
        _ = benchnav.rnu


def test_public_names_exist_and_are_documented():
    for module in (benchnav, leaderboard, navigation):
        assert len(module.__all__) == len(set(module.__all__))
        for name in module.__all__:
            thing = getattr(module, name)
            assert thing.__doc__ or not isinstance(thing, type | FunctionType), name


def imported_by(statement):
    code = f"{statement}\nimport sys; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return {name.partition(".")[0] for name in done.stdout.split()}


def test_importing_benchnav_imports_nothing_heavy():
    assert not imported_by("import benchnav") & set(HEAVY)


def test_the_modules_of_the_layer_below_the_commands_are_not_imported_either():
    loaded = imported_by("import benchnav; dir(benchnav)")
    assert not loaded & {*HEAVY, "pydantic", "yaml", "rich", "typer"}


def test_help_imports_nothing_heavy():
    loaded = imported_by("from benchnav.cli.main import app")
    assert not loaded & set(HEAVY)


def test_the_leaderboard_needs_no_extra():
    loaded = imported_by("import benchnav.leaderboard")
    assert not loaded & {
        "torch",
        "ompl",
        "gymnasium",
        "matplotlib",
        "ray",
        "trimesh",
        "fcl",
        "pandas",
        "pedpy",
    }
