"""Documents are executed, and their links lead somewhere."""

import re

import pytest

from tests.docs.blocks import ROOT, Reader, blocks, documents

LINK = re.compile(r"(?<!!)\[[^\]]*\]\((?P<to>[^)\s]+)\)|!\[[^\]]*\]\((?P<picture>[^)\s]+)\)")


LONG = {"cluster", "learning", "running", "verification"}


def named(paths):
    return [pytest.param(path, id=str(path.relative_to(ROOT))) for path in paths]


def executed():
    for document in documents():
        if blocks(document):
            mark = pytest.mark.long if document.stem in LONG else pytest.mark.slow
            yield pytest.param(document, id=str(document.relative_to(ROOT)), marks=mark)


@pytest.mark.parametrize("document", list(executed()))
def test_what_a_document_says_can_be_done(document, tmp_path):
    reader = Reader(tmp_path)
    for block in blocks(document):
        reader.follow(block)


@pytest.mark.parametrize("document", named(documents()))
def test_links_lead_somewhere(document):
    text = re.sub(r"```.*?```", "", document.read_text(encoding="utf-8"), flags=re.DOTALL)
    for found in LINK.finditer(text):
        target = (found["to"] or found["picture"]).split("#")[0]
        if target and not re.match(r"https?:|mailto:", target):
            assert (document.parent / target).exists(), target


def test_decisions_are_listed_and_short():
    folder = ROOT / "docs" / "decisions"
    listed = re.findall(r"\((\d{4}-[a-z-]+\.md)\)", (folder / "README.md").read_text("utf-8"))
    assert listed == sorted(p.name for p in folder.glob("0*.md"))
    for name in listed:
        lines = (folder / name).read_text("utf-8").splitlines()
        assert len(lines) <= 40
        assert lines[0].startswith(f"# {int(name[:4])}. ")
        assert all(
            f"**{part}.**" in "\n".join(lines)
            for part in ("Problem", "Decision", "Consequences", "Rejected")
        )


def test_the_glossary_has_every_word_once():
    text = (ROOT / "docs" / "glossary.md").read_text("utf-8")
    words = re.findall(r"^\| ([^|]+?) \|", text, re.MULTILINE)[2:]
    assert len(words) == len(set(words))
    assert {"scenario", "world", "navigator", "episode", "run", "leaderboard"} <= set(words)
