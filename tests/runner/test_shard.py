"""Shares of a plan: every episode in one of them, whoever computes it, and merged as one run."""

import pytest

from benchnav.errors import RunConflictError, UsageError
from benchnav.runner.plan import task as task_module
from benchnav.runner.plan.shard import Shard
from benchnav.runner.plan.suite import Selection, load_suite
from benchnav.runner.run import run_suite
from benchnav.store.runs.manifest import load_manifest
from benchnav.store.runs.merge import merge
from benchnav.store.runs.reading import read_episodes, read_results
from benchnav.store.runs.run_folder import RunFolder
from benchnav.store.runs.spans import count

SALT = "5a" * 16


@pytest.fixture
def path(tmp_path, scenario_file, troubled):
    path = tmp_path / "suite.yaml"
    path.write_text(
        f"name: small\nscenarios: [{scenario_file}]\nseeds: 7\ntracks: [known, unknown]\n"
        "navigators: [orca, ompl-pure, {type: 'troubled_navigators:Walk', label: walk}]\n"
    )
    return path


@pytest.fixture
def suite(path, monkeypatch):
    monkeypatch.setattr(task_module, "CHUNK", 3)
    return load_suite(str(path), Selection(salt=SALT, navigators=("orca", "walk")))


@pytest.mark.parametrize("text", ["1/1", "1/3", "3/3", "10000/10000"])
def test_a_shard_is_written_as_it_is_read(text):
    assert str(Shard.parse(text)) == text


@pytest.mark.parametrize("text", ["", "0/3", "4/3", "1", "a/b", "-1/3", "1/0", "1/10001", "1/3 "])
def test_what_is_no_shard_is_refused_with_the_rule(text):
    with pytest.raises(ValueError, match="must be i/n, with 1 ≤ i ≤ n"):
        Shard.parse(text)


@pytest.mark.parametrize("count", [1, 2, 3, 5, 40])
def test_shards_cover_the_plan_once_and_weigh_alike(path, count, monkeypatch):
    monkeypatch.setattr(task_module, "CHUNK", 2)
    suite = load_suite(str(path))
    jobs = list(suite.jobs())
    shares = [Shard(i, count).seeds(jobs, suite.seeds) for i in range(1, count + 1)]
    again = [Shard(i, count).seeds(reversed(jobs), suite.seeds) for i in range(1, count + 1)]
    assert shares == again
    for job in jobs:
        held = [seed for share in shares for seed in share.get(job.key, ())]
        assert sorted(held) == ([] if job.reason else list(suite.seeds))
    effort = {job.key: job.effort for job in jobs}
    loads = [sum(effort[k] * len(s) for k, s in share.items()) for share in shares]
    assert max(loads) - min(loads) <= 2 * max(effort.values())  # a task's


def facts(run):
    episodes = [(str(e.identity), e.digest) for e in read_episodes(run)]
    timed = ("decision_time", "planning_time", "latency", "peak_memory")
    rows = [r for r in read_results(run).to_pylist() if not r["metric"].startswith(timed)]
    return episodes, sorted(map(str, rows))


def test_shards_that_are_merged_are_the_run_that_nobody_shared_out(suite, tmp_path):
    whole, out = tmp_path / "whole", tmp_path / "out"
    total = run_suite(suite, whole, workers=0).total
    shards = [tmp_path / f"{i}" for i in (1, 2, 3)]
    for i, shard in enumerate(shards, start=1):
        summary = run_suite(suite, shard, workers=0, shard=Shard(i, 3))
        assert 0 < summary.stored == summary.total < total
        assert dict(RunFolder.open(shard).missing()) == {}
        assert run_suite(suite, shard, workers=0, shard=Shard(i, 3)).found == summary.stored
    some = merge(shards[:2], out)
    lacking = dict(some.run.missing())
    assert some.copied + sum(map(count, lacking.values())) == total
    assert lacking == {k: s for k, s in RunFolder.open(shards[2]).planned() if s}
    done = merge(shards, out)
    assert (done.copied, done.twice) == (total - some.copied, some.copied)
    assert facts(out) == facts(whole)
    assert load_manifest(out).shard == ""
    assert load_manifest(out).cells == load_manifest(whole).cells
    assert run_suite(suite, out, workers=0).found == total


def test_runs_that_overlap_are_merged_where_they_agree(suite, path, tmp_path, monkeypatch):
    whole, left, right = (tmp_path / name for name in ("whole", "left", "right"))
    run_suite(suite, whole, workers=0)
    run_suite(suite, left, workers=0, shard=Shard(1, 2))
    monkeypatch.setattr(task_module, "CHUNK", 2)  # cut otherwise
    run_suite(suite, right, workers=0)
    merged = merge([left, right], tmp_path / "out")
    assert merged.twice > 0
    assert facts(tmp_path / "out") == facts(whole)


def test_runs_that_disagree_are_refused(suite, tmp_path, monkeypatch):
    import troubled_navigators

    one, other = tmp_path / "one", tmp_path / "other"
    run_suite(suite, one, workers=0)
    monkeypatch.setattr(troubled_navigators.Walk, "fail", lambda self, command, b: command * 0.5)
    run_suite(suite, other, workers=0)
    with pytest.raises(RunConflictError, match=r"they must agree\. .* differ at seed [0-6]"):
        merge([one, other], tmp_path / "out")


def test_only_shares_of_one_run_are_merged(suite, path, tmp_path):
    one = tmp_path / "one"
    run_suite(suite, one, workers=0, shard=Shard(1, 4))
    changes = {
        "suite hash": (Selection(salt=SALT, navigators=("orca",)), {}),
        "salt": (Selection(salt="00", navigators=("orca", "walk")), {}),
        "limits": (Selection(salt=SALT, navigators=("orca", "walk")), {"timeout": 7.0}),
    }
    for name, (chosen, limits) in changes.items():
        other = tmp_path / name
        workers = 1 if limits else 0
        asked = load_suite(str(path), chosen)
        run_suite(asked, other, workers=workers, shard=Shard(4, 4), **limits)
        with pytest.raises(RunConflictError, match=f"must share their {name}"):
            merge([one, other], tmp_path / "out")
    with pytest.raises(UsageError, match="into another folder"):
        merge([one], one)
    assert not (tmp_path / "out").exists()


def test_a_shard_stays_what_it_is_and_has_the_salt_of_the_others(suite, path, tmp_path):
    out = tmp_path / "run"
    with pytest.raises(UsageError, match="must have the salt of the others"):
        run_suite(load_suite(str(path)), out, workers=0, shard=Shard(1, 2))
    assert not out.exists()
    run_suite(suite, out, workers=0, shard=Shard(1, 40))
    for other in (Shard(2, 40), None):
        with pytest.raises(RunConflictError, match="It holds shard 1/40"):
            run_suite(suite, out, workers=0, shard=other)
    with pytest.raises(RunConflictError, match="must be new or hold a merged run"):
        merge([tmp_path / "another"], out) if run_suite(
            suite, tmp_path / "another", workers=0, shard=Shard(2, 40)
        ) else None
