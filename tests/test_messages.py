"""Messages of the library fit Python and the command line: they name no option as `--option`."""

import ast
import re
from pathlib import Path

ROOT = Path(__file__).parents[1]
OPTION = re.compile(r"(?<![\w-])--[a-z]")
COMMANDS = {  # which show the command line of a program
    "benchnav/api/authoring/plugin_templates.py",
    "benchnav/isolation/sandbox.py",
    "benchnav/isolation/subprocess_host.py",
    "benchnav/report/analysis/best.py",
}


def messages(tree):
    """(line, text) of strings that are not docstrings, and contain a space as prose does."""
    bodies = (node.body for node in ast.walk(tree) if hasattr(node, "body"))
    docs = {
        id(body[0].value)
        for body in bodies
        if isinstance(body, list) and body and isinstance(body[0], ast.Expr)
    }
    for node in ast.walk(tree):
        is_text = isinstance(node, ast.Constant) and isinstance(node.value, str)
        if not is_text or id(node) in docs:
            continue
        if " " in node.value or node.value.endswith("--"):
            yield node.lineno, node.value


def test_no_message_outside_of_the_command_names_an_option():
    found = [
        f"{name}:{line}: {text}"
        for folder in ("benchnav", "baselines")
        for path in sorted((ROOT / folder).rglob("*.py"))
        if not (name := path.relative_to(ROOT).as_posix()).startswith("benchnav/cli/")
        and name not in COMMANDS
        for line, text in messages(ast.parse(path.read_text(encoding="utf-8")))
        if OPTION.search(text) or text.endswith(" --")
    ]
    assert not found, "\n".join(found)
