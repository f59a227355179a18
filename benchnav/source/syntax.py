"""References of Python code: imported modules, and strings that may name files."""

import ast
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache

_BY_TEXT = {
    "import_module", "__import__", "iter_modules", "walk_packages", "run_path", "run_module",
    "spec_from_file_location", "SourceFileLoader",
}  # fmt: skip
"""Calls that import modules without an import statement."""
MAX_LENGTH = 250  # characters of a string that may name a file
_PATTERN = str.maketrans({c: f"[{c}]" for c in "*?["})


@dataclass(frozen=True)
class References:
    """The references of one code file."""

    imports: frozenset[tuple[int, str, str]] = frozenset()
    """(level, module, name): ``from ..a import b`` is (2, "a", "b"); name is "" for ``import``."""
    texts: frozenset[str] = frozenset()  # as patterns of `glob`; * replaces fields of an f-string
    imports_by_text: bool = False


@lru_cache(4096)
def references(code: bytes) -> References:
    """Return the references of ``code``; none if it is not Python."""
    try:
        tree = ast.parse(code)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return References()
    imports: set[tuple[int, str, str]] = set()
    texts: set[str] = set()
    by_text = False
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            imports.update((0, alias.name, "") for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            imports.update((node.level, node.module or "", alias.name) for alias in node.names)
            by_text = by_text or any(alias.name in _BY_TEXT for alias in node.names)
        elif isinstance(node, ast.Name | ast.Attribute):
            by_text = by_text or _name_of(node) in _BY_TEXT
        elif isinstance(node, ast.Constant | ast.JoinedStr):
            texts.add(_pattern(node))
    usable = frozenset(t for t in texts if 0 < len(t) <= MAX_LENGTH and t.isprintable())
    return References(frozenset(imports), usable, by_text)


def _name_of(node: ast.Name | ast.Attribute) -> str:
    return node.id if isinstance(node, ast.Name) else node.attr


def _pattern(node: ast.Constant | ast.JoinedStr) -> str:
    if isinstance(node, ast.Constant):
        return node.value if isinstance(node.value, str) else ""
    parts = (
        str(part.value).translate(_PATTERN) if isinstance(part, ast.Constant) else "*"
        for part in node.values
    )
    return "".join(parts)


def imported(found: References, package: str) -> Iterator[str]:
    """Yield the modules that code in ``package`` may import; some names may be other objects."""
    for level, module, name in found.imports:
        base = module
        if level:
            outer = package.split(".")[: len(package.split(".")) - level + 1] if package else []
            if not outer:
                continue
            base = ".".join([*outer, module] if module else outer)
        if base:
            yield base
        if name and name != "*":
            yield f"{base}.{name}"
    if found.imports_by_text:
        yield from (text for text in found.texts if all(p.isidentifier() for p in text.split(".")))
