"""Every entry shows the mode in which it ran."""

import json

import pytest

from benchnav.cli.main import status

SUITE = """
name: modes
scenarios: [circle/antipodal]
tracks: [unknown]
navigators: [straight-line, random-walk]
seeds: 1
"""


@pytest.fixture
def shown(tmp_path, capfd):
    (tmp_path / "modes.yaml").write_text(SUITE)

    def shown(out, *options, format="json"):
        run = str(tmp_path / out)
        command = ["run", str(tmp_path / "modes.yaml"), "--workers", "0", "--quiet"]
        assert status([*command, "--out", run, *options]) == 0
        capfd.readouterr()
        assert status(["leaderboard", run, "--format", format]) == 0
        return capfd.readouterr().out

    return shown


def test_in_json_and_in_the_table(shown):
    for options, mode in ((), "in-process"), (("--isolate",), "isolated"):
        records = json.loads(shown(mode, *options))
        records = records if isinstance(records, list) else records["records"]
        assert {record["mode"] for record in records} == {mode}
        text = shown(mode, *options, format="markdown")
        assert f"mode: {mode} for all entries." in text
        assert "| mode" not in text  # a constant column


def test_a_run_in_one_mode_does_not_go_on_in_the_other(shown, tmp_path):
    shown("run")
    command = ["run", str(tmp_path / "modes.yaml"), "--workers", "0", "--quiet", "--isolate"]
    assert status([*command, "--out", str(tmp_path / "run")]) == 1
