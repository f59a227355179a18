"""`make bench` keeps a table only of rows that were all measured; ratios are of one run."""

import sys

import pytest

from benchmarks import __main__ as bench
from benchmarks import table
from benchmarks.check import failures
from benchmarks.pair import NotMeasuredError, Pair, Row, measured


def pair(ours, theirs=lambda: 3e5, **keys):
    keys = {"peer": "pyrvo 2", "wanted": 4.0, "unit": "agent-steps/s"} | keys
    return Pair(name="crowd", ours=ours, theirs=theirs, **keys)


def unable():
    raise NotMeasuredError("pyrvo is not installed")


@pytest.fixture
def command(monkeypatch, tmp_path):
    """Run the command with these pairs; return the table that it wrote, or None."""

    def run(*pairs, check=False):
        out = tmp_path / "table.md"
        words = ["--check"] if check else ["--out", str(out)]
        monkeypatch.setattr(sys, "argv", ["benchmarks", *words])
        monkeypatch.setattr(bench, "pairs", lambda peers: list(pairs))
        monkeypatch.setattr(bench, "KEPT", tmp_path / "kept.json")
        monkeypatch.setattr(bench, "keep", lambda rows: table.keep(rows, tmp_path / "kept.json"))
        monkeypatch.setattr(bench, "kept", lambda: table.kept(tmp_path / "kept.json"))
        out.unlink(missing_ok=True)
        try:
            bench.main()
        finally:
            run.kept = out.exists()
        return out.read_text() if out.exists() else None

    return run


def test_what_was_measured_is_kept(command):
    limited = pair(lambda: 5.0, lambda: 1.0, peer="", unit="s", wanted=0.4)
    text = command(pair(lambda: 9e5, limit="Sorting."), limited)
    assert "| crowd | 0.90 M agent-steps/s | pyrvo 2 | 3 [3, 3] | 4 × | no |" in text
    assert "| crowd | 0.2 s | yardstick | – | 0.4 s | yes |" in text
    assert "- Sorting. *crowd*" in text


def test_a_row_that_was_not_measured_fails(command):
    with pytest.raises(SystemExit) as failed:
        command(pair(lambda: 1.0, unable))
    assert not command.kept
    assert failed.value.code == (
        "Not measured, so no table was kept:\ncrowd: pyrvo is not installed"
    )


def test_both_sides_are_measured_in_turns():
    """A machine that slows down by a third at each measurement changes the ratio by nothing."""
    order, speed = [], [1.0]

    def side(name, rate):
        def measure():
            order.append(name)
            speed[0] *= 0.75
            return rate * speed[0]

        return measure

    row = measured(pair(side("A", 6.0), side("B", 2.0), blocks=2))
    assert "".join(order) == "AB" + "ABBA" * 2
    assert row.ratio == pytest.approx(3.0)
    assert row.low < 3.0 < row.high


def test_the_interval_holds_the_ratio_of_noisy_rates():
    rates = iter([1.0, *[1.0, 1.3, 0.8, 1.1] * 6])
    row = measured(pair(lambda: next(rates), lambda: 1.0, blocks=6))
    assert row.low <= row.ratio <= row.high
    assert row.value == 1.3


def test_only_a_row_whose_whole_interval_is_slower_fails():
    slow = Row(pair=pair(None), value=1.0, ratio=2.6, low=2.5, high=2.69)
    unsure = Row(pair=pair(None), value=1.0, ratio=2.6, low=2.5, high=2.71)
    assert failures([unsure], {"crowd": 3.0}) == []
    assert failures([slow], {}) == []
    (text,) = failures([slow], {"crowd": 3.0})
    assert text == "crowd: the ratio is 2.6 [2.5, 2.69], and 3 is kept"


def test_the_check_fails_when_a_ratio_fell(command):
    assert command(pair(lambda: 9e5)) is not None
    with pytest.raises(SystemExit) as passed:
        command(pair(lambda: 8.5e5), check=True)
    assert passed.value.code == 0
    with pytest.raises(SystemExit) as failed:
        command(pair(lambda: 8e5), check=True)
    assert failed.value.code == "crowd: the ratio is 2.67 [2.67, 2.67], and 3 is kept"


def test_a_check_needs_kept_ratios(command):
    with pytest.raises(SystemExit) as failed:
        command(pair(lambda: 9e5), check=True)
    assert "`make bench` writes it" in failed.value.code


def test_names_are_unique_because_ratios_are_kept_by_name():
    names = [one.name for one in bench.pairs(sys.executable)]
    assert len(set(names)) == len(names)
