"""What `import benchnav` promises, and what it must not cost."""

import subprocess
import sys

import benchnav
from benchnav import leaderboard

HEAVY = ("torch", "ompl", "gymnasium", "matplotlib", "ray", "trimesh", "fcl", "pandas", "pedpy",
         "pyarrow", "scipy", "shapely", "numba", "numpy")  # fmt: skip


def test_public_names():
    assert benchnav.__all__ == [
        "BenchnavError",
        "register_controller",
        "register_metric",
        "register_navigator",
        "register_planner",
    ]


def test_public_names_exist_and_are_documented():
    for module in (benchnav, leaderboard):
        assert module.__all__ == sorted(module.__all__)
        for name in module.__all__:
            assert getattr(module, name).__doc__, name


def imported_by(statement):
    code = f"{statement}\nimport sys; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return {name.partition(".")[0] for name in done.stdout.split()}


def test_importing_benchnav_imports_nothing_heavy():
    assert not imported_by("import benchnav") & set(HEAVY)


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
