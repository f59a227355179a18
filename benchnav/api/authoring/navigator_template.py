"""The files of a new navigator package."""

from benchnav.api.authoring.free_name import class_name, module_name

_PROJECT = """\
[build-system]
requires = ["setuptools>=80"]
build-backend = "setuptools.build_meta"

[project]
name = "{name}"
version = "0.1.0"
description = "A navigator for benchnav"
readme = "README.md"
requires-python = ">=3.11"
dependencies = ["benchnav"]

[project.optional-dependencies]
test = ["pytest"]

[project.entry-points."benchnav.navigators"]
{name} = "{module}:{cls}"
"""

_MODULE = '''\
"""The navigator {name} for benchnav."""

from benchnav.navigation.navigator import AgentNavigator, PluginConfig
from pydantic import Field


class {cls}(AgentNavigator):
    """Walk straight to the goal and slow down near it. Replace `act_agent` with your idea."""

    class Config(PluginConfig):
        pace: float = Field(1.0, gt=0, le=1, description="share of the preferred speed")

    def act_agent(self, view, briefing):
        """Return the velocity [m/s] of one agent, in the world frame."""
        way = view.goal - view.position
        speed = self.config.pace * briefing.preferred_speed[view.agent]
        return way * min(speed / max((way @ way) ** 0.5, 1e-9), 1 / briefing.dt)
'''

_TEST = '''\
"""The rules that every navigator keeps, as benchnav checks them."""

from benchnav.testing.check_navigator import check_navigator


def test_it_keeps_the_rules_of_a_navigator():
    check_navigator("{name}")
'''

_README = """\
# {name}

A navigator for [benchnav](https://pypi.org/project/benchnav/). Its code is in `src/{module}.py`.

    pip install -e ".[test]"
    pytest
    benchnav show {name}
    benchnav run quick --navigator {name} --navigator orca --out runs/first
    benchnav leaderboard runs/first

The test calls `check_navigator`, which runs the navigator in small worlds and reports violated
rules: a command of the wrong shape, memory that leaks between worlds, and so on.
"""


def navigator_package(name: str) -> dict[str, str]:
    """Return path → text of a complete package; all paths are relative to its folder."""
    module = module_name(name)
    words = {"name": name, "module": module, "cls": class_name(name)}
    files = {
        "pyproject.toml": _PROJECT,
        "README.md": _README,
        f"src/{module}.py": _MODULE,
        f"tests/test_{module}.py": _TEST,
    }
    return {path: text.format(**words) for path, text in files.items()}
