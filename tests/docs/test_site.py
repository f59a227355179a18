"""The documentation site names things that exist; `make docs` builds it."""

import re
from importlib import import_module

import pytest

from tests.docs.blocks import ROOT

DIRECTIVE = re.compile(r"^\.\. auto(?P<kind>module|class|function):: (?P<name>\S+)$", re.MULTILINE)
NAMES = [
    (page.stem, found["kind"], found["name"])
    for page in sorted((ROOT / "docs" / "reference").glob("*.md"))
    for found in DIRECTIVE.finditer(page.read_text(encoding="utf-8"))
]


def test_the_reference_covers_what_authors_need():
    pages = {page for page, _, _ in NAMES}
    assert pages >= {"checks", "errors", "navigation", "python", "tables"}


@pytest.mark.parametrize(("page", "kind", "name"), NAMES)
def test_what_the_reference_names_exists_and_has_a_docstring(page, kind, name):
    module, _, attribute = name.rpartition(".")
    thing = import_module(name) if kind == "module" else getattr(import_module(module), attribute)
    assert thing.__doc__, f"docs/reference/{page}.md: {name} has no docstring"
