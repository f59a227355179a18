"""The page of the suite `robots`, from a run of it: ``python -m studies.robots RUN``.

Executes the suite into the folder RUN (a run that was stopped continues), and writes
docs/results/robots.md: who copes with which body, the price of noise, and the price of
acceleration limits. ``--seeds N`` is for a first look.
"""

import argparse
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from textwrap import wrap
from typing import Any

import numpy as np
import pyarrow.compute as pc

from benchnav.leaderboard.from_runs import StoredValues, stored_values
from benchnav.leaderboard.record import ALL, NOISE, Leaderboard, Record
from benchnav.leaderboard.statistics.difference import Moments, difference
from benchnav.leaderboard.statistics.estimate import columns_of
from benchnav.leaderboard.statistics.strata import Stratum, strata
from benchnav.runner.execute.progress import progress
from benchnav.runner.plan.suite import Selection, load_suite
from benchnav.runner.run import run_suite
from benchnav.scenario.parameters import split_parameters
from benchnav.scenario.robots.registry import find_robot
from benchnav.store.runs.run_folder import RunFolder
from studies.paper.markdown import table

SUITE = "robots"
SALT = "0123456789abcdef0123456789abcdef"  # public, so that the run can be repeated
PAGE = Path(__file__).parents[1] / "docs" / "results" / "robots.md"
EVERY = "all"  # the column over all robots
LIMITS = "acceleration_limits"
ABSENT = "–"


@dataclass(frozen=True)
class Interval:
    """A difference in percentage points, or the reason why there is none."""

    value: float
    low: float
    high: float

    @property
    def text(self) -> str:
        """The difference with its interval: ``+3 [1, 5]``; bold if 0 lies outside."""
        if not np.isfinite(self.value):
            return ABSENT
        value, low, high = (round(100 * x) + 0 for x in (self.value, self.low, self.high))
        text = f"{value:+d} [{low}, {high}]".replace("-", "−").replace("+0 ", "0 ")
        return f"**{text}**" if self.low > 0 or self.high < 0 else text


@dataclass(frozen=True, eq=False)
class Evidence:
    """The results of the run, by robot."""

    run: RunFolder
    values: StoredValues

    @cached_property
    def robots(self) -> list[str]:
        """The robots, in the order of the suite."""
        return list(dict.fromkeys(_robot(name) for name in self._scenarios))

    @cached_property
    def navigators(self) -> list[str]:
        """The navigators, by falling success over all robots with exact senses."""
        found = self.successes[EVERY]
        return sorted(found, key=lambda name: -np.nan_to_num(found[name].value, nan=-1.0))

    @cached_property
    def boards(self) -> Mapping[str, Leaderboard]:
        """The leaderboard of each robot with its limits, and of all of them."""
        limited = [name for name in self._scenarios if not _is_free(name)]
        groups = {r: [n for n in limited if _robot(n) == r] for r in self.robots}
        return {key: self._board(names) for key, names in {**groups, EVERY: limited}.items()}

    @cached_property
    def successes(self) -> Mapping[str, Mapping[str, Record]]:
        """The robot, or `EVERY` → navigator → its success with exact senses."""
        return {key: _records(board, "success", "exact") for key, board in self.boards.items()}

    def price_of_noise(self, robot: str, navigator: str) -> Interval:
        """The success with exact senses minus that with noisy ones, in the same worlds."""
        found = _records(self.boards[robot], "success", NOISE.mark).get(navigator)
        return Interval(*((found.value, found.low, found.high) if found else [np.nan] * 3))

    def price_of_limits(self, robot: str, navigator: str) -> Interval:
        """The success without acceleration limits minus that with them, in the same worlds."""
        pairs = [
            (self._strata[free], self._strata[limited])
            for free in map(str, filter(_is_free, self._scenarios))
            if robot in (EVERY, _robot(free)) and (limited := _limited(free)) in self._strata
        ]
        both = [p for p in pairs if all(navigator in stratum.navigators for stratum in p)]
        parts = [Moments.of(_differences(*pair, navigator)) for pair in both]
        if not parts:
            return Interval(np.nan, np.nan, np.nan)
        found = difference(parts, columns_of([self.values.metrics["success"]]))
        return Interval(*(float(x[0]) for x in (found.value, found.low, found.high)))

    @property
    def _scenarios(self) -> list[str]:
        return [str(entry["scenario"]) for entry in self.run.manifest.suite["scenarios"]]

    @cached_property
    def _strata(self) -> Mapping[str, Stratum]:
        """Scenario → its successes with exact senses."""
        results = self.values.results
        kept = pc.and_(pc.equal(results["metric"], "success"), _is_exact(results))
        return {s.scenario: s for s in strata(results.filter(kept), self.values.metrics)}

    def _board(self, scenarios: Sequence[str]) -> Leaderboard:
        inside = pc.is_in(pc.cast(self.values.results["scenario"], "string"), _texts(scenarios))
        gaps = [gap for gap in self.values.not_applicable if gap.scenario in scenarios]
        part = StoredValues(
            results=self.values.results.filter(inside), metrics=self.values.metrics,
            caveats=(), not_applicable=gaps, verified=(), facts=self.values.facts,
        )  # fmt: skip
        return part.board(("success", "collided"))


def _texts(names: Iterable[str]) -> Any:
    import pyarrow as pa

    return pa.array(list(names), pa.string())


def _is_exact(results: Any) -> Any:
    return pc.equal(pc.cast(results["perception"], "string"), "exact")


def _robot(scenario: str) -> str:
    return str(split_parameters(scenario)[1]["robot"])


def _is_free(scenario: str) -> bool:
    return split_parameters(scenario)[1].get(LIMITS) is False


def _limited(scenario: str) -> str:
    """Return the same scenario with acceleration limits."""
    base, _ = split_parameters(scenario)
    return f"{base}:robot={_robot(scenario)}"


def _records(board: Leaderboard, metric: str, perception: str) -> dict[str, Record]:
    """Return navigator → its record over all scenarios of the board."""
    return {
        record.navigator: record
        for record in board.records
        if (record.scenario, record.metric, record.perception) == (ALL, metric, perception)
    }


def _differences(free: Stratum, limited: Stratum, navigator: str) -> Any:
    """Return the differences (n, 1) of one navigator over the common seeds."""
    _, one, other = np.intersect1d(free.seeds, limited.seeds, return_indices=True)
    a, b = (s.value[:, s.navigators.index(navigator), 0] for s in (free, limited))
    return (a[one] - b[other])[:, None]


def page(evidence: Evidence) -> str:
    """Return the page in Markdown."""
    manifest = evidence.run.manifest
    suite, version = manifest.suite, manifest.versions["benchnav"]
    seeds = suite["seeds"][1] - suite["seeds"][0]
    lines = [
        "# Robots: bodies, noise and acceleration limits",
        "",
        *_prose(
            f"The suite `{suite['name']}@{suite['version']}` with {seeds} seeds of the test split,"
            f" run with benchnav {version} on {manifest.created[:10]}, and written by `python -m"
            " studies.robots`. It drives four robots with their published limits through the four"
            " scenarios of the [family `robots`](../gallery.md), with exact and"
            " with noisy senses. [Bodies](../bodies.md) describes the robots,"
            " [observations](../observations.md) the senses."
        ),
        *table(("robot", "body"), [(f"`{r}`", find_robot(r).title) for r in evidence.robots]),
        *_copes(evidence),
        *_noise(evidence),
        *_limits(evidence),
    ]
    return "\n".join(lines).rstrip() + "\n"


def _prose(text: str) -> list[str]:
    """Return the lines of a paragraph, with an empty one after it."""
    return [*wrap(text, 115, break_long_words=False, break_on_hyphens=False), ""]


def _copes(evidence: Evidence) -> Iterator[str]:
    yield "## Who copes with which body"
    yield ""
    yield from _prose(
        "Success in % of the agents, mean over the four scenarios, exact senses; in parentheses the"
        " share of agents that collided. Bold: not significantly worse than any other navigator."
        f" {ABSENT}: does not drive this body."
    )
    yield from _table(evidence, evidence.robots, _success_cell)
    yield from table(
        ("scenario", *(f"`{robot}`" for robot in evidence.robots)),
        [(f"`{name}`", *cells) for name, cells in _by_scenario(evidence).items()],
    )
    yield from _prose("The second table is the mean success in % of all these navigators.")


def _by_scenario(evidence: Evidence) -> dict[str, list[str]]:
    """Return scenario → the mean success of all navigators for each robot."""
    found: dict[str, list[str]] = {}
    for robot in evidence.robots:
        values: dict[str, list[float]] = {}
        for r in evidence.boards[robot].records:
            if (r.metric, r.perception) == ("success", "exact") and "/" in r.scenario:
                values.setdefault(r.scenario.partition("@")[0], []).append(r.value)
        for name, each in values.items():
            found.setdefault(name, []).append(f"{100 * np.nanmean(each):.0f}")
    return found


def _success_cell(evidence: Evidence, robot: str, navigator: str) -> str:
    found = evidence.successes[robot].get(navigator)
    if found is None or not np.isfinite(found.value):
        return ABSENT
    hit = _records(evidence.boards[robot], "collided", "exact")[navigator]
    text = f"{100 * found.value:.0f} ({100 * hit.value:.0f})"
    return f"**{text}**" if found.rank_low == 1 else text


def _noise(evidence: Evidence) -> Iterator[str]:
    yield "## Price of noise"
    yield ""
    yield from _prose(
        "Success with exact senses minus success with noisy senses, in the same worlds, in"
        " percentage points with 95 % intervals; bold if the interval excludes 0."
    )
    price = Evidence.price_of_noise
    yield from _table(evidence, [*evidence.robots, EVERY], lambda e, r, n: price(e, r, n).text)
    yield from _prose(f"Over all robots, noise costs {_range(evidence, price)}.")


def _limits(evidence: Evidence) -> Iterator[str]:
    yield "## Price of acceleration limits"
    yield ""
    yield from _prose(
        "Success of the same robot without its acceleration limits minus success with them, in the"
        " same worlds of `robots/yard` and `robots/plaza`, exact senses, in percentage points with"
        " 95 % intervals; bold if the interval excludes 0."
    )
    price = Evidence.price_of_limits
    yield from _table(evidence, [*evidence.robots, EVERY], lambda e, r, n: price(e, r, n).text)
    yield from _prose(f"Over all robots, acceleration limits cost {_range(evidence, price)}.")


def _range(evidence: Evidence, price: Callable[[Evidence, str, str], Interval]) -> str:
    """Return the smallest and the largest price, each with its navigator."""
    prices = {name: price(evidence, EVERY, name) for name in evidence.navigators}
    known = [name for name in prices if np.isfinite(prices[name].value)]
    low, high = (pick(known, key=lambda name: prices[name].value) for pick in (min, max))
    texts = [f"{prices[name].text.strip('*')} points (`{name}`)" for name in (low, high)]
    return f"from {texts[0]} to {texts[1]}"


def _table(evidence: Evidence, columns: Sequence[str], cell: Any) -> list[str]:
    head = ["navigator", *(f"`{name}`" if name != EVERY else name for name in columns)]
    rows = [
        [f"`{navigator}`", *(cell(evidence, robot, navigator) for robot in columns)]
        for navigator in evidence.navigators
    ]
    return table(head, rows)


def main() -> None:
    """Run the suite, and write the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("run", type=Path)
    parser.add_argument("--seeds", default="")
    parser.add_argument("--out", type=Path, default=PAGE)
    options = parser.parse_args()
    wanted = Selection(seeds=options.seeds, salt=SALT)
    run_suite(load_suite(SUITE, wanted), options.run, progress=progress(quiet=False))
    run = RunFolder.open(options.run)
    options.out.write_text(page(Evidence(run, stored_values([run], notify=print))), "utf-8")


if __name__ == "__main__":
    main()
