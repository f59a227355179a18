"""What the other verbs print, and how mistakes are answered."""

import ast
import json
import re
import subprocess
import sys
import tomllib

import pytest
from jsonschema import Draft202012Validator

import benchnav
from benchnav.plugins import NAVIGATORS, PLANNERS
from benchnav.threads import core_count
from tests.installed import install


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (("lits",), "Did you mean 'list'"),
        (("run",), "Missing argument 'SUITE|SCENARIO'"),
        (("run", "quick", "--wrokers", "2"), "--workers"),
        (("run", "quick", "--workers", "two"), "--workers"),
        (("run", "quikc"), "Did you mean 'quick'"),
        (("run", "quick", "--seeds", "x"), "seeds must be N"),
        (("run", "quick", "--track", "knwon"), "Did you mean 'known'"),
        (("run", "quick", "--navigator", "orac"), "Did you mean 'orca'"),
        (("run", "quick", "--scenario", "trap/v"), "Did you mean 'trap/u'"),
        (("run", "quick", "--shard", "3/2"), "The shard must be i/n, with 1 ≤ i ≤ n"),
        (("run", "quick", "--shard", "1/2"), "must have the salt of the others"),
        (("run", "quick", "--executor", "rya"), "Did you mean 'ray'"),
        (("run", "quick", "--executor", "ray", "--workers", "0"), "needs workers"),
        (("run", "quick", "--address", "auto"), "An address belongs to a Ray cluster"),
        (("run", "quick", "--timeout", "0"), "timeout must be above 0"),
        (("run", "quick", "--memory", "1", "--workers", "0"), "must have a worker process"),
        (("merge", "--out", "x"), "RUN"),
        (("list", "navigator"), "Did you mean 'navigators'"),
        (("show", "orac"), "Did you mean 'orca'"),
        (("leaderboard", ".", "--format", "latx"), "Did you mean 'latex'"),
        (("schema", "scenarios"), "Did you mean 'scenario'"),
        (("validate", "gone.yaml"), "gone.yaml:1: cannot be read"),
        (("import", "movingai", "gone.map", "--out", "x.yaml"), "gone.map"),
        (("new", "navigator", "Big Name"), "must be small letters"),
        (("new", "navigator", "orca"), "must be free"),
    ],
)
def test_who_asks_wrongly_is_corrected_without_a_traceback(call, arguments, complaint):
    code, stdout, stderr = call(*arguments)
    assert (code, stdout) == (2, "")
    assert complaint in stderr
    assert "Traceback" not in stderr


def test_help_and_version(call):
    code, stdout, _ = call("--help")
    assert code == 0
    for verb in ("run", "leaderboard", "list", "show", "validate", "schema", "import", "doctor"):
        assert verb in stdout
    code, stdout, _ = call("--version")
    assert code == 0
    assert stdout.splitlines()[0] == benchnav.__version__
    assert "\nprocessor  " in stdout


def test_help_imports_nothing_heavy():
    """In a process of its own: what this one has imported says nothing."""
    code = (
        "import sys; from benchnav.cli.main import status; status(['--help'])\n"
        "heavy = {'numpy', 'numba', 'scipy', 'pyarrow', 'pandas', 'shapely', 'torch', 'ompl',"
        " 'matplotlib', 'pedpy', 'rich.progress'}\n"
        "assert not heavy & set(sys.modules), heavy & set(sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def test_list_names_everything_and_where_it_comes_from(call):
    code, stdout, stderr = call("list")
    assert (code, stderr) == (0, "")
    for name in ("straight-line", "ompl.rrt-connect", "path-following", "trap/u", "quick", "spl"):
        assert f"  {name} " in stdout
    navigators = call("list", "navigators")[1]
    assert all(name in navigators for name in NAVIGATORS.names())
    assert f"benchnav {benchnav.__version__}" in navigators


def test_a_broken_plugin_is_listed_with_its_cause(call, monkeypatch, tmp_path):
    install(monkeypatch, tmp_path / "site", "", navigators={"gone": "no_such_module:Thing"})
    code, stdout, _ = call("list", "navigators")
    assert code == 0
    line = next(line for line in stdout.splitlines() if line.startswith("gone"))
    assert "broken" in line
    assert "No module named 'no_such_module'" in line
    code, stdout, _ = call("doctor")
    assert code == 1
    assert "WRONG" in stdout


def test_show_says_parameters_units_needs_and_source(call):
    stdout = call("show", "orca")[1]
    assert "a navigator: Optimal reciprocal" in stdout
    assert "a controller: " in stdout
    assert "time_horizon" in stdout
    assert "[s]" in stdout
    assert "edges, neighbours" in stdout
    assert "baselines/controllers/orca/navigator.py:" in stdout


def test_show_describes_a_navigator_named_by_its_parts(call):
    stdout = call("show", "mapping+grid.astar+orca")[1]
    assert "needs       edges, neighbours, rays" in stdout
    assert "grid.astar\n  is          a planner" in stdout
    assert "orca\n  is          a controller" in stdout
    assert "Did you mean 'orca'" in call("show", "grid.astar+orcaa")[2]


def test_show_describes_metrics_scenarios_and_suites(call):
    assert "Anderson" in call("show", "spl")[1]
    assert "higher" in call("show", "spl")[1]
    assert "a scenario: " in call("show", "leaders/dynamic")[1]
    assert "driven by" in call("show", "crowd/circle-crossing")[1]
    quick = call("show", "quick")[1]
    assert "ompl-orca" in quick
    assert "0 … 19 of split test" in quick


@pytest.mark.parametrize("of", ["scenario", "suite"])
def test_schemas_are_schemas(call, of):
    Draft202012Validator.check_schema(json.loads(call("schema", of)[1]))


def test_validate_tells_scenarios_from_suites(call, suite):
    code, stdout, _ = call("validate", suite)
    assert code == 0
    assert "is a suite, tiny@1: 2 cells, 0 of them n/a, × 2 seeds" in stdout
    code, stdout, _ = call("validate", suite.parent / "open.yaml")
    assert code == 0
    assert "is a scenario, tiny/open@1" in stdout
    assert "2 agents" in stdout


def test_validate_names_file_line_and_key(call, tmp_path):
    path = tmp_path / "wrong.yaml"
    path.write_text("name: a/b\nbounds: [0, 0, 1, 1]\nteams: []\nwals: []\n")
    code, _, stderr = call("validate", path)
    assert code == 2
    assert f"{path}:3: teams" in stderr
    assert f"{path}:4: wals is not a known key. Did you mean 'walls'" in stderr


def test_validate_draws_a_world_and_says_when_none_can_be(call, suite):
    path = suite.parent / "open.yaml"
    path.write_text(
        path.read_text().replace("radius: 0.2", "radius: 1.4").replace("count: 2", "count: 9")
    )
    code, _, stderr = call("validate", path)
    assert code == 2
    assert "tiny/open" in stderr
    assert call("validate", path, "--no-draw")[0] == 0


MAP = "type octile\nheight 4\nwidth 6\nmap\n......\n..@@..\n......\n......\n"


def test_import_writes_a_scenario_that_can_be_run(call, tmp_path):
    (tmp_path / "small.map").write_text(MAP)
    out = tmp_path / "made" / "small.yaml"
    code, stdout, _ = call(
        "import", "movingai", tmp_path / "small.map", "--out", out, "--agents", "2"
    )
    assert code == 0
    assert stdout.splitlines() == [str(out), str(out.parent / "small.map")]
    assert call("validate", out)[0] == 0
    code, _, stderr = call("import", "movingai", tmp_path / "small.map", "--out", out)
    assert code == 2
    assert "must not exist yet" in stderr


def test_new_writes_a_package_of_fifteen_lines_that_works(call, tmp_path, suite, monkeypatch):
    target = tmp_path / "my-idea"
    code, stdout, _ = call("new", "navigator", "my-idea", "--out", target)
    assert (code, stdout) == (0, f"{target}\n")
    source = (target / "src" / "my_idea.py").read_text()
    lines = [line for line in source.splitlines() if line.strip()]
    assert len(lines) <= 15
    ast.parse(source)
    project = tomllib.loads((target / "pyproject.toml").read_text())
    assert project["project"]["entry-points"]["benchnav.navigators"] == {
        "my-idea": "my_idea:MyIdea"
    }
    monkeypatch.syspath_prepend(target / "src")
    code, _, stderr = call(
        "run", suite, "--out", tmp_path / "o", "--workers", 0, "--navigator", "my_idea:MyIdea"
    )
    assert code == 0
    assert "failed" not in stderr
    assert call("new", "navigator", "my-idea", "--out", target)[0] == 2


def test_doctor_counts_what_can_be_used_and_says_what_is_missing(call, monkeypatch, tmp_path):
    kinds = ("navigators", "planners", "controllers")
    whole = " ".join(call("doctor")[1].split())
    for name in ("ompl", "networkx"):
        monkeypatch.setitem(sys.modules, name, None)
        gone = f"raise ModuleNotFoundError(\"No module named '{name}'\", name='{name}')"
        (tmp_path / f"{name}.py").write_text(gone)  # for the processes that make plugins
    monkeypatch.syspath_prepend(tmp_path)
    code, stdout, _ = call("doctor")
    assert code == 0
    lines = [" ".join(line.split()) for line in stdout.splitlines()]
    assert "- extra [plan] without ompl, networkx: pip install 'benchnav[plan]'" in lines
    for registry, names, cause in (
        (PLANNERS, [n for n in PLANNERS.names() if n.startswith("ompl.")], "An OMPL planner"),
        (NAVIGATORS, ["ompl-orca", "ompl-pure"], "An OMPL planner"),
    ):
        assert (
            f"- {registry.kind}s without {', '.join(names)}."
            f" {cause} needs an extra: pip install 'benchnav[plan]'" in lines
        )
    usable = [int(re.search(rf"{kind} +(\d+) can be used", whole)[1]) for kind in kinds]
    left = [int(re.search(rf"{kind} +(\d+) can be used", stdout)[1]) for kind in kinds]
    assert [a - b for a, b in zip(usable, left, strict=True)] == [2, 5, 0]
    assert "ors without" not in whole
    assert f"{core_count()}, so" in stdout


def test_a_reader_that_has_seen_enough_is_no_error():
    code = "from benchnav.cli.main import main; main()"
    command = f'{sys.executable} -c "{code}" schema | head -n 1'
    done = subprocess.run(["bash", "-c", command], capture_output=True, text=True)
    assert done.stdout == "{\n"
    assert done.stderr == ""


def test_show_says_what_a_learned_navigator_needs(call):
    assert "  needs       rays\n" in call("show", "recurrent-ppo")[1]
    assert "  needs       edges, neighbours, rays\n" in call("show", "recurrent-ppo-vo")[1]
    assert "  needs       edges, neighbours\n" in call("show", "recurrent-ppo-plus")[1]
