"""A Ray cluster of two machines, one of which dies: the parts and bits of a local run."""

import sys
from collections import Counter

import pytest

from benchnav.errors import BenchnavError, MissingExtraError
from benchnav.runner.execute.progress import Progress
from benchnav.runner.plan import task as task_module
from benchnav.runner.plan.limits import Limits
from benchnav.runner.plan.suite import Selection, load_suite
from benchnav.runner.ray import ray_executor
from benchnav.runner.ray.ray_executor import execute_on_ray
from benchnav.runner.run import run_suite
from benchnav.store.parts.part import SEAL
from benchnav.store.runs.reading import read_episodes, read_results
from benchnav.store.runs.run_folder import RunFolder

TIMINGS = ("decision_time", "planning_time", "latency", "peak_memory")


@pytest.fixture
def suite(tmp_path, scenario_file, troubled, monkeypatch):
    monkeypatch.setattr(task_module, "CHUNK", 2)
    path = tmp_path / "suite.yaml"
    path.write_text(
        f"name: small\nscenarios: [{scenario_file}]\nseeds: '3:7'\nnavigators:\n"
        "  - {type: 'troubled_navigators:Walk', label: walk}\n"
        "  - {type: 'troubled_navigators:Dies', label: dies}\n"
    )
    return load_suite(str(path), Selection(salt="5a" * 16))


@pytest.fixture
def cluster(monkeypatch):
    """Two machines with a core each, and no dashboard."""
    pytest.importorskip("ray", reason="needs the extra: pip install 'benchnav[ray]'")
    monkeypatch.setenv("RAY_USAGE_STATS_ENABLED", "0")
    from ray.cluster_utils import Cluster

    cluster = Cluster(
        initialize_head=True, head_node_args={"num_cpus": 1, "include_dashboard": False}
    )
    cluster.add_node(num_cpus=1)
    yield cluster
    cluster.shutdown()


def facts(run):
    """Episodes, and values but timings."""
    episodes = {
        (e.identity.navigator, e.identity.seed): (e.digest, e.failure) for e in read_episodes(run)
    }
    values = Counter(
        str({k: v for k, v in row.items() if k != "rehearsal_seconds"})
        for row in read_results(run).to_pylist()
        if not row["metric"].startswith(TIMINGS)
    )
    return episodes, values


class Kills(Progress):
    """Ends a machine as soon as something is stored."""

    def __init__(self, cluster):
        self.cluster, self.done = cluster, 0

    def advance(self, episodes):
        if not self.done:
            node = next(n for n in self.cluster.worker_nodes)
            self.cluster.remove_node(node, allow_graceful=False)
        self.done += episodes


@pytest.mark.long
def test_a_machine_that_dies_changes_nothing(suite, tmp_path, cluster, monkeypatch):
    lost = []
    lose = ray_executor._RayJobs._replace
    monkeypatch.setattr(
        ray_executor._RayJobs, "_replace", lambda *said: (lost.append(said[2]), lose(*said))
    )
    told = Kills(cluster)
    start = ray_executor._RayJobs._start_actor

    def start_at_once(jobs):  # an actor that is still being placed moves to another machine
        start(jobs)
        if not told.done:
            jobs.ray.wait(list(jobs.waiting), num_returns=len(jobs.waiting), timeout=120)

    monkeypatch.setattr(ray_executor._RayJobs, "_start_actor", start_at_once)

    def on_the_cluster(tasks, workers, progress, limits):
        return execute_on_ray(tasks, workers, progress, limits, cluster.address)

    there, here = tmp_path / "there", tmp_path / "here"
    summary = run_suite(suite, there, executor=on_the_cluster, progress=told)
    assert (summary.stored, told.done) == (8, 8)
    assert not cluster.worker_nodes
    assert lost, "the machine had an actor"
    run_suite(suite, here, workers=2)
    assert facts(there) == facts(here)
    died = {why for (who, _), (_, why) in facts(there)[0].items() if who == "dies" and why}
    assert died == {"the navigator's process ended with exit status 7"}
    assert parts(there) == parts(here)
    assert dict(RunFolder.open(there).missing()) == {}
    assert not list(there.rglob(".writing*"))


def parts(run):
    return sorted(str(p.relative_to(run)) for p in run.glob(f"parts/*/*{SEAL}"))


def test_without_ray_the_extra_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "ray", None)
    with pytest.raises(
        MissingExtraError, match=r"'ray' needs an extra: pip install 'benchnav\[ray"
    ):
        next(execute_on_ray([], 1, Progress(), Limits()))


def test_a_machine_with_other_versions_is_refused(monkeypatch):
    monkeypatch.setattr(ray_executor, "versions", lambda: {"numpy": "2", "numba": "1"})
    ray_executor._refuse_other_versions({"numpy": "2", "numba": "1"})
    with pytest.raises(BenchnavError, match="One has numba none for 1, numpy 3 for 2"):
        ray_executor._refuse_other_versions({"numpy": "3"})
