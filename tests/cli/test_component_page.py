"""The pages of components are those of the code."""

from pathlib import Path

from benchnav.api.components.component_page import INDEX, pages
from benchnav.plugins import CONTROLLERS, NAVIGATORS, PLANNERS

KEPT = Path(__file__).parents[2] / "docs" / "components"


def test_the_kept_pages_are_up_to_date():
    made = pages()
    kept = {path.name: path.read_text("utf-8") for path in KEPT.glob("*.md")}
    again = "python -m benchnav.api.components.component_page docs/components"
    assert sorted(kept) == sorted(made), again
    assert [name for name in made if kept[name] != made[name]] == [], again


def test_every_component_has_a_page_with_its_parameters():
    made = pages()
    for registry in (NAVIGATORS, PLANNERS, CONTROLLERS):
        for name in registry.names():
            page = made[f"{registry.kind}-{name}.md"]
            for parameter in registry.load(name).Config.model_fields:
                assert f"| {parameter} |" in page
            assert f"]({registry.kind}-{name}.md)" in made[INDEX]
