"""Names, docstrings, comments and messages are plain English: they contain no banned words."""

import ast
import io
import re
import tokenize
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
NAMES = frozenset(
    {"told", "said", "says", "whom", "who", "whose", "whoever"}
    | {"somebody", "nobody", "everybody", "anybody"}
)
PROSE = re.compile(r"\b(whom|whoever|nobody|everybody|somebody|anybody)\b", re.IGNORECASE)
HEADLESS = re.compile(r"(?:^|[.:;!?]\s+)(Who|What)\b[^.?!]*(?P<end>[.?!]|$)")

# Keys of stored files, which keep their old names: (file, name).
KEYS_ON_DISK = {("benchnav/store/runs/manifest_schema.py", "says")}

# Modules that still await their rewrite. Shorten this list; never lengthen it.
EXCEPTIONS: tuple[str, ...] = (
    "baselines/learned/q_learning/recipe.py",
    "benchmarks/isolation.py",
    "benchmarks/leader_arena.py",
    "benchmarks/orca_peers.py",
    "benchmarks/scale.py",
    "benchnav/cli/running/pack.py",
    "benchnav/cli/running/train.py",
    "benchnav/cli/viewing/inspection.py",
    "benchnav/envs/agent_batch.py",
    "benchnav/envs/autoreset.py",
    "benchnav/envs/background_agents.py",
    "benchnav/envs/encoders/encoder.py",
    "benchnav/envs/encoders/surround.py",
    "benchnav/envs/gym/leader_env.py",
    "benchnav/envs/gym/spaces.py",
    "benchnav/envs/parallel_env.py",
    "benchnav/envs/trainer.py",
    "benchnav/leaderboard/caveats.py",
    "benchnav/leaderboard/columns.py",
    "benchnav/leaderboard/remarks.py",
    "benchnav/leaderboard/rendering/curve_table.py",
    "benchnav/leaderboard/rendering/knowledge_gap_table.py",
    "benchnav/leaderboard/rendering/layout.py",
    "benchnav/leaderboard/rendering/matrix.py",
    "benchnav/leaderboard/rendering/prose.py",
    "benchnav/leaderboard/statistics/not_comparable.py",
    "benchnav/leaderboard/table.py",
    "benchnav/metrics/compute.py",
    "benchnav/metrics/congestion.py",
    "benchnav/metrics/following.py",
    "benchnav/metrics/groups.py",
    "benchnav/metrics/page.py",
    "benchnav/metrics/quantities/encounters.py",
    "benchnav/metrics/quantities/trajectory.py",
    "benchnav/metrics/success.py",
    "benchnav/navigation/__init__.py",
    "benchnav/navigation/agent_view.py",
    "benchnav/navigation/briefing.py",
    "benchnav/navigation/command_check.py",
    "benchnav/navigation/controller.py",
    "benchnav/navigation/hierarchy/composition.py",
    "benchnav/navigation/hierarchy/hierarchical.py",
    "benchnav/navigation/hierarchy/hierarchical_config.py",
    "benchnav/navigation/hierarchy/learned_map.py",
    "benchnav/navigation/hierarchy/mapping.py",
    "benchnav/navigation/hierarchy/plan_log.py",
    "benchnav/navigation/hierarchy/replanning.py",
    "benchnav/navigation/navigator.py",
    "benchnav/navigation/observation.py",
    "benchnav/navigation/planner.py",
    "benchnav/navigation/plugin/capabilities.py",
    "benchnav/navigation/plugin/configure.py",
    "benchnav/navigation/plugin/contract.py",
    "benchnav/navigation/plugin/guarded_capabilities.py",
    "benchnav/navigation/plugin/plugin_process.py",
    "benchnav/navigation/randomness/briefing_seed.py",
    "benchnav/navigation/rehearsal.py",
    "benchnav/navigation/row_table.py",
    "benchnav/navigation/tracks.py",
    "benchnav/plugins.py",
    "benchnav/runner/conclusion.py",
    "benchnav/runner/execute/plugin_metrics.py",
    "benchnav/runner/execute/progress.py",
    "benchnav/runner/plan/contestant.py",
    "benchnav/runner/plan/installed_differences.py",
    "benchnav/runner/plan/job.py",
    "benchnav/runner/plan/limits.py",
    "benchnav/runner/plan/prepare.py",
    "benchnav/runner/plan/renewal.py",
    "benchnav/runner/plan/shard.py",
    "benchnav/runner/plan/source_check.py",
    "benchnav/runner/plan/suite.py",
    "benchnav/runner/plan/suite_file.py",
    "benchnav/runner/plan/task.py",
    "benchnav/runner/rollouts/latency.py",
    "benchnav/runner/rollouts/navigator_driver.py",
    "benchnav/runner/rollouts/rehearsal.py",
    "benchnav/runner/rollouts/rollout.py",
    "benchnav/runner/rollouts/seeding.py",
    "benchnav/runner/rollouts/tamper_guard.py",
    "benchnav/runner/run.py",
    "benchnav/testing/check_controller.py",
    "benchnav/testing/check_metric.py",
    "benchnav/testing/check_navigator.py",
    "benchnav/testing/check_planner.py",
    "benchnav/testing/episodes.py",
    "benchnav/testing/observations.py",
    "benchnav/testing/requirement.py",
)


def modules() -> list[Path]:
    """Return all modules that the rules apply to."""
    folders = ("benchnav", "baselines", "benchmarks")
    return [path for folder in folders for path in sorted((ROOT / folder).rglob("*.py"))]


def problems_of(path: Path) -> list[tuple[int, str]]:
    """Return (line, problem) of each violation in a module that is not a key on disk."""
    name = path.relative_to(ROOT).as_posix()
    keys = {f"the name {key}" for file, key in KEYS_ON_DISK if file == name}
    found = violations(path.read_text(encoding="utf-8"))
    return [(line, problem) for line, problem in found if problem not in keys]


def names_in(tree: ast.AST) -> Iterator[tuple[int, str]]:
    """Yield (line, name) of functions, classes, arguments, variables and attributes."""
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            yield node.lineno, node.name
        elif isinstance(node, ast.arg):
            yield node.lineno, node.arg
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            yield node.lineno, node.id
        elif isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store):
            yield node.lineno, node.attr


def is_banned(name: str) -> bool:
    """Whether a part of a name is a banned word; parts are separated by _ or by capitals."""
    return not NAMES.isdisjoint(re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name).lower().split("_"))


def prose_in(source: str, tree: ast.AST) -> Iterator[tuple[int, str]]:
    """Yield (line, text) of comments, docstrings and messages; a message contains a space."""
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type == tokenize.COMMENT:
            yield token.start[0], token.string.lstrip("#: ")
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and " " in node.value:
            yield node.lineno, node.value


def violations(source: str) -> list[tuple[int, str]]:
    """Return (line, problem) of each violation in a module's source."""
    tree = ast.parse(source)
    found = [(line, f"the name {name}") for line, name in names_in(tree) if is_banned(name)]
    for line, text in prose_in(source, tree):
        words = [match[0] for match in PROSE.finditer(text)]
        words += [m[1] for m in HEADLESS.finditer(" ".join(text.split())) if m["end"] != "?"]
        found += [(line, f"the word {word!r}") for word in words]
    return sorted(found)


@pytest.mark.parametrize(
    "source",
    [
        "told = 1", "def f(whose): ...", "class WhoCame: ...", "x.said_last = 1",
        "x = 1  # nobody reads it", '"""What a run holds."""', 'x = "Ask somebody else."',
        'def f():\n    """Return x. Who asks gets it."""',
    ],
)  # fmt: skip
def test_a_violation_is_found(source: str) -> None:
    assert violations(source)


@pytest.mark.parametrize(
    "source", ["whole = 1", '"""What is new?"""', "x = 1  # the agents that moved", 'y["says"] = 2']
)
def test_plain_english_passes(source: str) -> None:
    assert not violations(source)


def test_code_is_written_in_plain_english() -> None:
    skipped = {path for pattern in EXCEPTIONS for path in ROOT.glob(pattern)}
    lines = [
        f"{path.relative_to(ROOT)}:{line}: {problem}"
        for path in modules()
        if path not in skipped
        for line, problem in problems_of(path)
    ]
    assert not lines, "Rewrite these by the rules in CONTRIBUTING.md:\n" + "\n".join(lines)


def test_exceptions_are_still_needed() -> None:
    clean = [
        pattern
        for pattern in EXCEPTIONS
        if not any(problems_of(path) for path in ROOT.glob(pattern))
    ]
    assert not clean, f"These modules are clean. Remove from EXCEPTIONS: {', '.join(clean)}"
