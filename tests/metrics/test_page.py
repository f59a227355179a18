"""The generated page is up to date."""

from pathlib import Path

from benchnav.metrics.page import page

PAGE = Path(__file__).parents[2] / "docs" / "metrics.md"


def test_page_says_what_the_registry_says():
    assert PAGE.read_text(encoding="utf-8") == page(), (
        "docs/metrics.md is out of date: python -m benchnav.metrics.page > docs/metrics.md"
    )
