"""`make bench` keeps a table only of rows that were all measured."""

import sys

import pytest

from benchmarks import __main__ as bench
from benchmarks import orca_peers

PEER = {
    "name": "ORCA crowd of 1,000, 1 thread against pyrvo 2", "value": 9e5, "unit": "agent-steps/s",
    "peer": 3e5, "ratio": 3.0, "wanted": 4,
}  # fmt: skip
LIMIT = {"name": "start", "value": 0.2, "unit": "s", "wanted": 0.4, "ratio": 2.0}


@pytest.fixture
def measured(monkeypatch, tmp_path):
    """Run the command with these rows of the crowd; return the file of its table."""

    def run(*crowd):
        out = tmp_path / "table.md"
        monkeypatch.setattr(sys, "argv", ["benchmarks", "--peers", "python", "--out", str(out)])
        monkeypatch.setattr(orca_peers, "measure", lambda peers: list(crowd))
        for part in (bench.leader_arena, bench.isolation):
            monkeypatch.setattr(part, "measure", list)
        monkeypatch.setattr(bench.end_to_end, "measure", lambda: [LIMIT])
        out.unlink(missing_ok=True)
        try:
            bench.main()
        finally:
            run.kept = out.exists()
        return out.read_text()

    return run


def test_what_was_measured_is_kept(measured):
    text = measured(PEER)
    name = "ORCA crowd of 1,000, 1 thread against pyrvo 2"
    assert f"| {name} | 0.90 M agent-steps/s | 0.30 M: 3.0 × | 4 × | no |" in text
    assert "| start | 0.2 s | – | 0.4 s | yes |" in text


def test_a_row_that_was_not_measured_fails(measured):
    with pytest.raises(SystemExit) as failed:
        measured({"name": "ORCA crowd against pyrvo", "note": "pyrvo is not installed"})
    assert not measured.kept
    assert failed.value.code.startswith("Not measured, so no table was kept:\n")
    assert failed.value.code.endswith("ORCA crowd against pyrvo: pyrvo is not installed")


def test_ratios_compare_rates_of_one_run(monkeypatch):
    """A crowd against a peer, and against another crowd of ours."""

    def ask(python, part, crowd):
        if part == "navground":
            return {"skipped": "navground is not installed"}
        seconds = crowd.agents * crowd.steps / 1e6 * (0.5 if part == "pyrvo" else 1.0)
        return {"version": "1", "seconds": seconds / crowd.threads}

    monkeypatch.setattr(orca_peers, "ask", ask)
    rows = {row["name"]: row for row in orca_peers.measure("python")}
    assert len(rows) == len(orca_peers.WANTED)
    assert rows["ORCA crowd of 100, 1 thread against pyrvo 1"]["ratio"] == 0.5
    two = rows["ORCA crowd of 1,000, 2 threads against ORCA crowd of 1,000, 1 thread"]
    assert (two["ratio"], two["wanted"]) == (2.0, 1.6)
    other = rows["ORCA crowd of 1,000, 1 thread against navground"]
    assert other["note"] == "navground is not installed"


def test_the_peers_must_be_given(monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["benchmarks"])
    with pytest.raises(SystemExit) as failed:
        bench.main()
    assert failed.value.code == 2
    assert "--peers" in capsys.readouterr().err


def test_a_peer_that_is_not_installed_says_so(monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    assert "is not installed" in orca_peers.ask(sys.executable, "pyrvo")["skipped"]


@pytest.mark.slow
def test_parts_do_not_find_our_files_in_place_of_packages(monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    assert orca_peers.ask(sys.executable, "benchnav")["seconds"] > 0
