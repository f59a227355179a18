"""Kernels are compiled ahead of the first run."""

import benchnav
from benchnav.api.execution import warm


def test_doctor_compiles_ahead_and_says_nothing_else(monkeypatch, tmp_path, capsys):
    suite = tmp_path / "short.yaml"
    suite.write_text("name: short\nscenarios: [trap/u]\nnavigators: [visibility+orca]\n")
    monkeypatch.setattr(warm, "SUITE", str(suite))
    monkeypatch.setattr(warm, "SCENARIOS", ("trap/u",))
    found = benchnav.doctor(warm=True, quiet=True)
    assert found.healthy
    assert any(check.subject == "kernel cache" for check in found.checks)
    assert capsys.readouterr() == ("", "")
