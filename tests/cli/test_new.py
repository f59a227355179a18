"""The package that `benchnav new` writes is complete, and the tutorial shows it."""

import tomllib

from benchnav.api.authoring.navigator_template import navigator_package
from benchnav.cli.main import status
from tests.docs.blocks import NAMED, ROOT, blocks


def test_it_writes_a_src_layout_with_test_and_readme(tmp_path, capfd):
    target = tmp_path / "my-bot"
    assert status(["new", "navigator", "my-bot", "--out", str(target)]) == 0
    written = {str(p.relative_to(target)) for p in target.rglob("*") if p.is_file()}
    assert written == {"pyproject.toml", "README.md", "src/my_bot.py", "tests/test_my_bot.py"}
    project = tomllib.loads((target / "pyproject.toml").read_text())
    assert project["project"]["entry-points"]["benchnav.navigators"] == {"my-bot": "my_bot:MyBot"}
    out, err = capfd.readouterr()
    assert out == f"{target}\n"
    assert "pytest" in err


def test_the_tutorial_shows_these_files():
    shown = {}
    for block in blocks(ROOT / "docs" / "navigators.md"):
        named = NAMED.match(block.text)
        if named:
            path = named["name"].removeprefix("keep-away/")
            shown.setdefault(path, block.text.removeprefix(named[0]))
    package = navigator_package("keep-away")
    for path in ("pyproject.toml", "src/keep_away.py", "tests/test_keep_away.py"):
        assert shown[path] == package[path], path
