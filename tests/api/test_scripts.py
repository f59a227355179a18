"""Scripts and notebooks that a user writes."""

import subprocess
import sys

import pytest

DEFINED = """
import benchnav
from benchnav.navigation import AgentNavigator

print("top level", flush=True)


class Mine(AgentNavigator):
    def act_agent(self, view, briefing):
        return view.goal - view.position


def greedy(view, briefing):
    return view.goal - view.position

"""
RUN = """
run = benchnav.run({scenario!r}, navigators=[Mine, greedy, "orca"], seeds=2, out="out", workers=1,
                   quiet=True)
print(run.navigators, run.summary.in_process, dict(run.summary.failures), run.summary.stored)
print(bool(run.verify(twin=0, workers=1, quiet=True)))
"""
ANSWER = "top level\n('Mine', 'greedy', 'orca') {alone} {{}} 6\nTrue\n"


@pytest.fixture
def execute(tmp_path):
    def execute(*arguments, text=None):
        return subprocess.run(
            [sys.executable, *arguments], cwd=tmp_path, input=text, capture_output=True,
            text=True, check=False,
        )  # fmt: skip

    return execute


@pytest.mark.slow
@pytest.mark.parametrize("guarded", [False, True])
def test_a_script_runs_what_it_defines_in_workers(scenario_file, execute, tmp_path, guarded):
    body = RUN.format(scenario=str(scenario_file))
    if guarded:
        body = "if __name__ == '__main__':\n" + "".join(f"    {x}\n" for x in body.splitlines())
    (tmp_path / "script.py").write_text(DEFINED + body)
    done = execute("script.py")
    assert done.stdout == ANSWER.format(alone="()"), done.stderr
    assert done.returncode == 0


@pytest.mark.slow
def test_what_a_notebook_defines_runs_in_its_process_and_says_so(scenario_file, execute):
    done = execute("-", text=DEFINED + RUN.format(scenario=str(scenario_file)))
    assert done.stdout == ANSWER.format(alone="('Mine', 'greedy')"), done.stderr
