"""Names, docstrings, comments, messages and documents contain no banned words."""

import ast
import io
import re
import tokenize
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
NAMES = frozenset(
    {"told", "said", "says", "whom", "who", "whose", "whoever", "tell", "tells", "lacks"}
    | {"somebody", "nobody", "everybody", "anybody"}
)
PROSE = re.compile(r"\b(whom|whoever|nobody|everybody|somebody|anybody)\b", re.IGNORECASE)
HEADLESS = re.compile(r"(?:^|[.:;!?]\s+)(Who|What)\b[^.?!]*(?P<end>[.?!]|$)")

IN_DOCUMENTS = re.compile(
    r"\b(?:whom|whoever|told|somebody|nobody|everybody|anybody)\b"
    r"|(?:[;:(]|\b(?:and|but|or|for|to|of|with|by)) who\b",
    re.IGNORECASE,
)
FENCE = re.compile(r"^(```|~~~|:::).*?^\1\s*$", re.MULTILINE | re.DOTALL)
QUOTED = re.compile(r"`[^`]*`|(?<!\*)\*\w+\*(?!\*)")  # code, and words in italics
NOT_PROSE = re.compile(r"\s*(?:\||#|!\[|---+$)")  # tables, headings, pictures, lines
NEW_PARAGRAPH = re.compile(r"^\s*(?:[-*] |\d+\. )")


def modules() -> list[Path]:
    """Return all modules that the rules apply to."""
    folders = ("benchnav", "baselines", "benchmarks", "studies")
    return [path for folder in folders for path in sorted((ROOT / folder).rglob("*.py"))]


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


def documents() -> list[Path]:
    """Return all documents that the rules apply to."""
    return [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted(ROOT.glob("docs/**/*.md"))]


def paragraphs(text: str) -> Iterator[tuple[int, str]]:
    """Yield (line, text) of paragraphs and list items, without code, headings and tables."""
    text = FENCE.sub(lambda found: "\n" * found[0].count("\n"), text)
    start, words = 1, list[str]()
    for number, line in enumerate([*text.splitlines(), ""], 1):
        ends = not line.strip() or NOT_PROSE.match(line)
        if words and (ends or NEW_PARAGRAPH.match(line)):
            yield start, " ".join(words)
            words = []
        if not ends:
            start = start if words else number
            words.append(NEW_PARAGRAPH.sub("", line, count=1).strip())


def violations_in_document(text: str) -> list[tuple[int, str]]:
    """Return (line of the paragraph, problem) of each violation in a Markdown document."""
    found = []
    for line, paragraph in paragraphs(text):
        prose = QUOTED.sub("…", paragraph).replace("*", "")
        words = [match[0] for match in IN_DOCUMENTS.finditer(prose)]
        words += [m[1] for m in HEADLESS.finditer(prose) if m["end"] != "?"]
        found += [(line, f"the word {word!r}") for word in words]
    return found


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
    lines = [
        f"{path.relative_to(ROOT)}:{line}: {problem}"
        for path in modules()
        for line, problem in violations(path.read_text(encoding="utf-8"))
    ]
    assert not lines, "Rewrite these by the rules in CONTRIBUTING.md:\n" + "\n".join(lines)


@pytest.mark.parametrize(
    "text",
    [
        "The run is told.", "Nobody reads it.", "- Who arrives\n  ends.",
        "It ends. What is left stays.", "The goal of who arrives.",
        "# Title\n\nA line,\n**Whoever** reads.",
        "It stops; who lacks values has no rank.",
    ],
)  # fmt: skip
def test_a_violation_in_a_document_is_found(text: str) -> None:
    assert violations_in_document(text)


@pytest.mark.parametrize(
    "text",
    [
        "**What happens to old results?**\nThey stay.", "Agents who arrive vanish.",
        "## What it does", "| who | what |", "```text\nnobody\n```\nText.", "Run `told`.",
        "No *who*.", "It shows what is missing.",
    ],
)  # fmt: skip
def test_a_document_in_plain_english_passes(text: str) -> None:
    assert not violations_in_document(text)


def test_documents_are_written_in_plain_english() -> None:
    lines = [
        f"{path.relative_to(ROOT)}:{line}: {problem}"
        for path in documents()
        for line, problem in violations_in_document(path.read_text(encoding="utf-8"))
    ]
    assert not lines, "Rewrite these by the rules in CONTRIBUTING.md:\n" + "\n".join(lines)
