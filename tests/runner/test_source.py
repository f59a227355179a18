"""Code that is edited between runs: old results are never taken for the new code's."""

import importlib
import os
import subprocess
import sys
import time
from pathlib import Path

import pyarrow as pa
import pytest

from benchnav.errors import RunConflictError, UsageError
from benchnav.leaderboard.label import require_one_navigator_per_label
from benchnav.plugins import CONTROLLERS, NAVIGATORS, register_controller, register_navigator
from benchnav.runner.plan import contestant as entry_module
from benchnav.runner.plan import task as task_module
from benchnav.runner.plan.shard import Shard
from benchnav.runner.plan.suite import Selection, load_suite
from benchnav.runner.run import run_suite
from benchnav.source.digest import FoundSource
from benchnav.store.parts.part import SEAL
from benchnav.store.parts.results import RESULTS
from benchnav.store.runs.manifest import load_manifest
from benchnav.store.runs.merge import merge
from benchnav.store.runs.reading import read_episodes, read_results
from benchnav.store.runs.run_folder import RunFolder
from benchnav.verify.verify import Wanted, verify

MODULE = """
from pathlib import Path
from benchnav.navigation.controller import Controller
from benchnav.navigation.navigator import AgentNavigator

class Drifts(AgentNavigator):
    def act_agent(self, view, briefing):
        gain = float((Path(__file__).parent / "gain.txt").read_text())
        return GAIN * gain * (view.goal - view.position)

class Steers(Controller):
    def steer(self, observation, guide):
        return GAIN * (guide.target - observation.position)
"""


@pytest.fixture
def edit(tmp_path, monkeypatch):
    """Write the module of the navigators with another gain, as an editor does."""
    folder = tmp_path / "modules"
    folder.mkdir()
    monkeypatch.syspath_prepend(str(folder))
    monkeypatch.setenv("PYTHONPATH", str(folder))

    def edit(gain, weight=1.0):
        sys.modules.pop("edited_navigators", None)
        text = MODULE.replace("GAIN", repr(gain))
        (folder / "edited_navigators.py").write_text(text)
        (folder / "gain.txt").write_text(repr(weight))

    edit(0.5)
    yield edit
    sys.modules.pop("edited_navigators", None)


@pytest.fixture
def suite_of(tmp_path, scenario_file, monkeypatch):
    monkeypatch.setattr(task_module, "CHUNK", 2)
    path = tmp_path / "suite.yaml"
    path.write_text(
        f"name: small\nscenarios: [{scenario_file}]\nseeds: 5\nnavigators:\n"
        "  - {type: 'edited_navigators:Drifts', label: drifts}\n"
        "  - {type: hierarchical, label: pair, planner: none,\n"
        "     controller: 'edited_navigators:Steers'}\n"
        "  - straight-line\n"
    )

    def load(*navigators, seeds="5"):
        return load_suite(str(path), Selection(navigators=navigators, seeds=seeds, salt="5a" * 16))

    return load


def digests(run, label="drifts"):
    found = [e for e in read_episodes(run) if e.identity.navigator == label]
    assert len({e.identity.source_hash for e in found}) <= 1
    assert len({e.identity.seed for e in found}) == len(found)
    return {e.identity.seed: e.digest for e in found}


def rows_of(run):
    return {(r["navigator"], r["source_hash"]) for r in read_results(run).to_pylist()}


@pytest.mark.parametrize("how", [{"gain": 0.25}, {"gain": 0.5, "weight": 0.5}])
def test_edited_code_and_weights_are_refused_and_run_again(edit, suite_of, tmp_path, how):
    out = tmp_path / "r"
    run_suite(suite_of("drifts", "straight-line"), out, workers=0)
    old, other = digests(out), digests(out, "straight-line")
    assert run_suite(suite_of("drifts", "straight-line"), out, workers=0).found == 10
    edit(**how)
    text = "source changed: 5 episodes were made by older code; the option 'again' repeats them"
    with pytest.raises(RunConflictError, match=text):
        run_suite(suite_of("drifts", "straight-line"), out, workers=0)
    assert digests(out) == old
    summary = run_suite(suite_of("drifts", "straight-line"), out, workers=0, again=True)
    assert (summary.total, summary.found, summary.stored) == (10, 5, 10)
    assert summary.replaced == {"drifts": 5}
    assert all(digests(out)[seed] != old[seed] for seed in range(5))
    assert digests(out, "straight-line") == other
    assert len(list(out.glob("parts/*"))) == 2
    fresh = tmp_path / "fresh"
    run_suite(suite_of("drifts", "straight-line"), fresh, workers=0)
    assert digests(fresh) == digests(out)
    assert rows_of(fresh) == rows_of(out)
    assert run_suite(suite_of("drifts", "straight-line"), out, workers=0).found == 10


def test_the_controller_of_a_pair_counts(edit, suite_of, tmp_path):
    out = tmp_path / "r"
    run_suite(suite_of("pair"), out, workers=0)
    edit(0.25)
    with pytest.raises(RunConflictError, match="5 episodes were made by older code"):
        run_suite(suite_of("pair"), out, workers=0)
    straight = suite_of("straight-line")
    run_suite(straight, tmp_path / "s", workers=0)
    edit(0.125)
    assert run_suite(straight, tmp_path / "s", workers=0).found == 5


def test_an_edit_in_the_middle_of_a_suite_does_not_mix(edit, suite_of, tmp_path):
    out = tmp_path / "r"
    run_suite(suite_of("drifts"), out, workers=0)
    sorted(out.glob(f"parts/*/*{SEAL}"))[0].unlink()
    edit(0.25)
    with pytest.raises(RunConflictError, match="3 episodes were made by older code"):
        run_suite(suite_of("drifts"), out, workers=0)
    run_suite(suite_of("drifts"), out, workers=0, again=True)
    assert len(digests(out)) == 5


class _Stop(Exception):
    pass


def stopped(monkeypatch, after):
    """Have the run die at the start of a task."""
    genuine, count = task_module.work, iter(range(1000))

    def work(task, tick):
        if next(count) == after:
            raise _Stop
        return genuine(task, tick)

    monkeypatch.setattr("benchnav.runner.execute.executor.work", work)


def test_an_interrupted_again_keeps_the_old_whole_and_goes_on(
    edit, suite_of, tmp_path, monkeypatch
):
    out = tmp_path / "r"
    run_suite(suite_of("drifts"), out, workers=0)
    old = digests(out)
    edit(0.25)
    with monkeypatch.context() as patch:
        stopped(patch, after=2)
        with pytest.raises(_Stop):
            run_suite(suite_of("drifts"), out, workers=0, again=True)
    assert digests(out) == old
    report = verify(RunFolder.open(out), Wanted(twin=0), workers=0)
    assert report.clean
    assert report.notes["cell of other source, which an unfinished repetition left"] == 1
    assert "another source is installed here" in report.sources[0]
    with pytest.raises(RunConflictError, match="5 episodes were made by older code"):
        run_suite(suite_of("drifts"), out, workers=0)
    summary = run_suite(suite_of("drifts"), out, workers=0, again=True)
    assert (summary.found, summary.stored) == (4, 5)
    assert all(digests(out)[seed] != old[seed] for seed in old)
    report = verify(RunFolder.open(out), Wanted(twin=0), workers=0)
    assert report.clean
    assert "the source that ran is installed here" in report.sources[0]


def test_another_edit_after_an_interrupted_again_starts_anew(edit, suite_of, tmp_path, monkeypatch):
    out = tmp_path / "r"
    run_suite(suite_of("drifts"), out, workers=0)
    edit(0.25)
    with monkeypatch.context() as patch:
        stopped(patch, after=2)
        with pytest.raises(_Stop):
            run_suite(suite_of("drifts"), out, workers=0, again=True)
    edit(0.125)
    summary = run_suite(suite_of("drifts"), out, workers=0, again=True)
    assert (summary.found, summary.stored, summary.replaced) == (0, 5, {"drifts": 5})
    assert len(list(out.glob("parts/*"))) == 1


def test_code_that_is_edited_back_finds_its_episodes(edit, suite_of, tmp_path):
    out = tmp_path / "r"
    run_suite(suite_of("drifts"), out, workers=0)
    edit(0.25)
    edit(0.5)
    assert run_suite(suite_of("drifts"), out, workers=0).found == 5


def test_fewer_seeds_again_do_not_replace_more(edit, suite_of, tmp_path):
    out = tmp_path / "r"
    run_suite(suite_of("drifts"), out, workers=0)
    old = digests(out)
    edit(0.25)
    summary = run_suite(suite_of("drifts", seeds="2"), out, workers=0, again=True)
    assert (summary.older, summary.replaced) == (5, {})
    assert digests(out) == old


def test_shards_of_two_versions_are_not_merged(edit, suite_of, tmp_path):
    for i in (1, 2):
        run_suite(suite_of("drifts"), tmp_path / f"s{i}", workers=0, shard=Shard(i, 2))
        edit(0.25)
    with pytest.raises(RunConflictError, match="must share the source of 'drifts'"):
        merge([tmp_path / "s1", tmp_path / "s2"], tmp_path / "whole")
    run_suite(suite_of("drifts"), tmp_path / "s1", workers=0, shard=Shard(1, 2), again=True)
    merged = merge([tmp_path / "s1", tmp_path / "s2"], tmp_path / "new")
    assert merged.copied == 5
    assert len(digests(tmp_path / "new")) == 5
    assert verify(RunFolder.open(tmp_path / "new"), Wanted(twin=0), workers=0).clean


def test_tables_refuse_one_label_for_two_versions_and_say_what_differs(edit, suite_of, tmp_path):
    run_suite(suite_of("drifts"), tmp_path / "a", workers=0)
    edit(0.25)
    run_suite(suite_of("drifts"), tmp_path / "b", workers=0)
    tables = {name: read_results(tmp_path / name) for name in ("a", "b")}
    with pytest.raises(UsageError, match="their source differs"):
        require_one_navigator_per_label(tables)
    unknown = pa.repeat(pa.scalar("", pa.string()), len(tables["a"]))
    place = RESULTS.get_field_index("source_hash")
    tables["a"] = tables["a"].set_column(place, RESULTS.field("source_hash"), unknown)
    require_one_navigator_per_label(tables)  # older runs say nothing of it


def test_a_run_that_recorded_no_source_is_read_and_not_extended(
    edit, suite_of, tmp_path, monkeypatch
):
    out = tmp_path / "r"
    with monkeypatch.context() as before:
        before.setattr(entry_module, "source_of", lambda _: FoundSource("", ()))
        run_suite(suite_of("drifts"), out, workers=0)
    assert load_manifest(out).sources == {}
    assert len(digests(out)) == 5
    with pytest.raises(RunConflictError, match="whose source was not recorded then: drifts"):
        run_suite(suite_of("drifts"), out, workers=0)
    assert run_suite(suite_of("drifts"), out, workers=0, again=True).replaced == {"drifts": 5}


def test_a_worker_does_not_run_code_that_was_edited_meanwhile(edit, suite_of, tmp_path):
    suite = suite_of("drifts")
    edit(0.25)
    with pytest.raises(RunConflictError, match="must stay as it is until a worker"):
        run_suite(suite, tmp_path / "r", workers=1)
    assert not list(tmp_path.glob(f"r/parts/*/*{SEAL}"))


def test_this_process_does_not_run_what_it_imported_before_an_edit(edit, suite_of, tmp_path):
    run_suite(suite_of("drifts"), tmp_path / "r", workers=0)
    imported = sys.modules["edited_navigators"]
    edit(0.25)
    sys.modules["edited_navigators"] = imported  # a notebook has no reason to import it anew
    with pytest.raises(UsageError, match="edited_navigators was edited after this process"):
        run_suite(suite_of("drifts"), tmp_path / "new", workers=0)
    assert run_suite(suite_of("drifts"), tmp_path / "new", workers=1).stored == 5
    importlib.reload(imported)
    run_suite(suite_of("drifts"), tmp_path / "here", workers=0)
    assert digests(tmp_path / "here") == digests(tmp_path / "new")


@pytest.mark.slow
def test_a_killed_again_ends_as_if_nobody_had_killed_it(edit, suite_of, tmp_path, monkeypatch):
    """The real thing: a command, SIGKILL once some new parts are sealed, and the command again."""
    out, path = tmp_path / "r", suite_of("drifts") and tmp_path / "suite.yaml"
    monkeypatch.setattr(task_module, "CHUNK", 64)  # as in the command
    run_suite(suite_of("drifts", seeds="200"), out, workers=0)
    old = digests(out)
    edit(0.25)
    start = [sys.executable, "-c", "from benchnav.cli.main import main; main()", "run", str(path)]
    options = ["--navigator", "drifts", "--seeds", "200", "--workers", "1", "--out", str(out)]
    command = [*start, *options]
    refused = subprocess.run(command, capture_output=True, text=True, check=False)
    assert refused.returncode == 1
    assert "source changed: 200 episodes were made by older code" in refused.stderr
    process = subprocess.Popen([*command, "--again"], env=os.environ, stderr=subprocess.DEVNULL)
    deadline = time.monotonic() + 300
    known = set(out.glob("parts/*"))
    while time.monotonic() < deadline and process.poll() is None:
        if [p for new in set(out.glob("parts/*")) - known for p in new.glob(f"[!.]*{SEAL}")]:
            break
        time.sleep(0.01)
    process.kill()
    process.wait()
    assert digests(out) == old
    subprocess.run([*command, "--again"], check=True, capture_output=True)
    run_suite(suite_of("drifts", seeds="200"), tmp_path / "fresh", workers=0)
    assert digests(out) == digests(tmp_path / "fresh")


@pytest.fixture
def registered():
    """Register in this process; forgotten afterwards."""
    before = [dict(NAVIGATORS._local), dict(CONTROLLERS._local)]
    yield register_navigator, register_controller
    NAVIGATORS._local, CONTROLLERS._local = before


def made(gain):
    from benchnav.navigation.navigator import AgentNavigator

    class Cell(AgentNavigator):
        def act_agent(self, view, briefing):
            return gain * (view.goal - view.position)

    return Cell


def test_what_is_registered_here_runs_here_beside_workers(registered, edit, suite_of, tmp_path):
    register, _ = registered
    register("of-this-session")(made(0.5))
    suite = suite_of("of-this-session", "straight-line")
    summary = run_suite(suite, tmp_path / "r", workers=1)
    assert summary.stored == 10
    assert summary.in_process == ("of-this-session",)
    assert not summary.failures
    with pytest.raises(UsageError, match="known only in this process"):
        run_suite(suite, tmp_path / "limited", workers=1, timeout=5.0)


def test_a_controller_of_this_session_runs_here_too(registered, edit, suite_of, tmp_path):
    from edited_navigators import Steers

    class Mine(Steers):
        pass

    registered[1]("controller-of-mine")(Mine)
    summary = run_suite(suite_of("none+controller-of-mine"), tmp_path / "r", workers=1)
    assert summary.in_process == ("none+controller-of-mine",)
    assert not summary.failures
    chosen = Selection(navigators=("none+controller-of-mine",), isolate=True)
    with pytest.raises(UsageError, match="registered in this process alone"):
        load_suite(str(tmp_path / "suite.yaml"), chosen)


def test_what_a_module_registered_runs_in_workers(registered, edit, suite_of, tmp_path):
    from edited_navigators import Drifts

    registered[0]("by-decorator")(Drifts)
    summary = run_suite(suite_of("by-decorator"), tmp_path / "r", workers=1)
    assert summary.in_process == ()
    assert summary.stored == 5
    assert not summary.failures


def test_an_edited_cell_is_not_taken_for_the_old_one(registered, edit, suite_of, tmp_path):
    register, _ = registered
    register("of-this-session")(made(0.5))
    run_suite(suite_of("of-this-session"), tmp_path / "r")
    register("of-this-session")(made(0.5))
    assert run_suite(suite_of("of-this-session"), tmp_path / "r").found == 5
    register("of-this-session")(made(0.25))
    suite = suite_of("of-this-session")
    with pytest.raises(RunConflictError, match="source changed: 5 episodes"):
        run_suite(suite, tmp_path / "r")
    assert run_suite(suite, tmp_path / "r", again=True).replaced == {"of-this-session": 5}


@pytest.mark.slow
@pytest.mark.parametrize("guarded", [False, True])
def test_a_script_registers_for_its_workers(edit, suite_of, tmp_path, guarded):
    load = suite_of and suite_of("straight-line")
    assert load.seeds.stop == 5
    define = "@benchnav.register_navigator('scripted')\nclass Scripted(Drifts): pass\n"
    body = f"""
suite = load_suite({str(tmp_path / "suite.yaml")!r}, Selection(navigators=("scripted",)))
summary = run_suite(suite, Path("out"), workers=1)
print(summary.stored, summary.in_process, dict(summary.failures))
"""
    inner = (define if guarded else "") + body
    script = tmp_path / "script.py"
    script.write_text(
        "from pathlib import Path\nimport benchnav\nfrom edited_navigators import Drifts\n"
        "from benchnav.runner.run import run_suite\n"
        "from benchnav.runner.plan.suite import Selection, load_suite\n"
        + ("" if guarded else define)
        + "if __name__ == '__main__':\n"
        + "".join(f"    {line}\n" for line in inner.splitlines())
    )
    found = subprocess.run(
        [sys.executable, str(script)], capture_output=True, text=True, check=False, cwd=tmp_path
    )
    assert found.stdout.strip() == f"5 {('scripted',) if guarded else ()} {{}}", found.stderr
    assert Path(tmp_path / "out").is_dir()
