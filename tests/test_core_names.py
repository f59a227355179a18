"""The core works without the baselines, so it names none of them."""

import ast
from pathlib import Path

import benchnav
from benchnav.plugins import CONTROLLERS, NAVIGATORS, PLANNERS, TRAINERS

CORE = Path(benchnav.__file__).parent


def shipped_names():
    return {
        name
        for registry in (NAVIGATORS, PLANNERS, CONTROLLERS, TRAINERS)
        for name in registry.names()
        if registry.source(name).value.startswith("benchnav_baselines.")
    }


def test_no_text_of_the_core_is_the_name_of_a_shipped_plugin():
    shipped = shipped_names()
    assert len(shipped) > 20
    found = [
        f"{path.relative_to(CORE)}:{node.lineno}: {node.value!r}"
        for path in sorted(CORE.rglob("*.py"))
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Constant) and node.value in shipped
    ]
    assert found == []
