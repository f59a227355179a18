"""The list of navigators, and a page for each of them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING
from urllib.parse import urlencode

from benchnav.leaderboard.record import IGNORANCE, PRICES, Price, Record
from benchnav.leaderboard.rendering.cell import cell, column
from benchnav.metrics.success import success
from benchnav.report.analysis.configuration import facts_of, parameters_of, training_text
from benchnav.report.analysis.cost import MEANINGS, costs
from benchnav.report.analysis.failures import OutcomeShares, outcome_shares
from benchnav.report.analysis.price import WORDS, price_sentence, prices_of
from benchnav.report.analysis.profile import Profile, profile
from benchnav.report.analysis.view import View, title_of, views_of
from benchnav.report.figure import figure_html
from benchnav.report.figures.cost import times_figure, value_figure
from benchnav.report.figures.failures import LINES, outcomes_figure
from benchnav.report.figures.price import price_figure
from benchnav.report.figures.profile import profile_figure
from benchnav.report.figures.style import height_of
from benchnav.report.page import COMPARISON, FAILURES, NAVIGATORS, Page, href, navigator_path
from benchnav.report.pages.grouping import grouped
from benchnav.report.pages.records import records_with
from benchnav.report.report_data import ReportData
from benchnav.report.template import fill
from benchnav.scenario.condition import condition

if TYPE_CHECKING:
    from markupsafe import Markup

LATENCIES = ("latency_p50", "latency_p95", "latency_p99")
DECISIONS = ("decision_time_p50", "decision_time_p95", "decision_time_p99")
NAMES = tuple(dict.fromkeys((*MEANINGS, *LATENCIES, *DECISIONS)))
SCATTER = 460  # [px]


def pages(data: ReportData) -> Iterator[Page]:
    """Yield the page with all navigators, then one for each."""
    shared = _Shared(data)
    yield _list(shared)
    for name in data.navigators:
        yield _page(shared, name)


@dataclass(frozen=True, eq=False)
class _Shared:
    """The results that the pages of all navigators share, computed once."""

    data: ReportData

    @cached_property
    def records(self) -> list[Record]:
        """The records of success and of all costs."""
        return records_with(self.data, (success.name, *NAMES))

    @cached_property
    def views(self) -> list[View]:
        """Every view of the results."""
        return views_of(self.records)

    @cached_property
    def profile(self) -> Profile:
        """The success of each navigator in each family."""
        families = grouped(self.data.scenarios, lambda s: s.family)
        values = self.data.values
        return profile(
            values.results, values.metrics, success.name,
            {name: [s.identity for s in found] for name, found in families.items()},
        )  # fmt: skip

    @cached_property
    def costs(self) -> dict[View, dict[str, dict[str, Record]]]:
        """The costs of each navigator in each view."""
        return {view: costs(self.records, view, NAMES) for view in self.views}

    @cached_property
    def outcomes(self) -> dict[View, dict[str, dict[str, OutcomeShares]]]:
        """The outcomes of each navigator in each view and scenario."""
        return {view: outcome_shares(self.data.summaries, view) for view in self.views}

    @cached_property
    def success(self) -> dict[View, dict[str, Record]]:
        """The success of each navigator in each view over all scenarios."""
        by_metric = {v: costs(self.records, v, (success.name,)) for v in self.views}
        return {view: found.get(success.name, {}) for view, found in by_metric.items()}


def _list(shared: _Shared) -> Page:
    data = shared.data
    figures = [
        figure_html(
            value_figure(shared.success[view], times, data.styles), height=SCATTER,
            label=f"Success against the time of a decision, {title_of(view, shared.views)}",
            caption=f"{title_of(view, shared.views)}: up and to the left is better.",
        )
        for view in shared.views
        for times in [_times(shared.costs[view])]
        if times and shared.success[view]
    ]  # fmt: skip
    columns = [
        column([shared.success[view].get(name) for name in data.navigators], decided=False)
        for view in shared.views
    ]
    rows = [
        {
            "navigator": name, "style": data.styles[name],
            "training": training_text(data.navigator_configs[name].get("training")),
            "map": data.navigator_configs[name].get("uses_map") is not False,
            "values": [cells[k].text or "–" for cells in columns],
        }
        for k, name in enumerate(data.navigators)
    ]  # fmt: skip
    heads = [title_of(view, shared.views) for view in shared.views]
    body = fill(
        "navigators.html", page=NAVIGATORS, rows=rows, heads=heads,
        figures=figures,
    )  # fmt: skip
    return Page(NAVIGATORS, "Navigators", body, NAVIGATORS, has_figures=True)


def _times(found: Mapping[str, Mapping[str, Record]]) -> Mapping[str, Record]:
    """Return the median latencies; without them, the median times of decisions."""
    return found.get(LATENCIES[0]) or found.get(DECISIONS[0], {})


def _text(record: Record | None) -> str:
    return "–" if record is None else cell(record, interval=True, decided=False).text


def _page(shared: _Shared, name: str) -> Page:
    entry = shared.data.navigator_configs[name]
    body = fill(
        "navigator.html",
        page=navigator_path(name),
        navigator=name,
        style=shared.data.styles[name],
        comparison=f"{href(navigator_path(name), COMPARISON)}#{urlencode({'a': name})}",
        failures=FAILURES,
        facts=facts_of(entry),
        trained=bool(entry.get("training")),
        parameters=parameters_of(entry["config"]),
        profiles=list(_profiles(shared, name)),
        prices=[
            (price.name.capitalize(), WORDS[price], found)
            for price in PRICES
            for found in [list(_prices(shared, name, price))]
            if found or price is IGNORANCE or not shared.data.is_exact
        ],
        costs=list(_costs(shared, name)),
        outcomes=list(_outcomes(shared, name)),
        reasons=list(_reasons(shared, name)),
    )
    return Page(navigator_path(name), name, body, NAVIGATORS, has_figures=True)


def _profiles(shared: _Shared, name: str) -> Iterator[Markup]:
    for view in shared.views:
        families = shared.profile.get(view, {})
        rows = sum(name in found for found in families.values())
        if rows:
            title = title_of(view, shared.views)
            yield figure_html(
                profile_figure(families, name, shared.data.styles[name]),
                height=height_of(rows, 1), label=f"Success of {name} by family, {title}",
                caption=f"{title}: mean over the scenarios of a family, with its 95 % interval.",
            )  # fmt: skip


def _prices(shared: _Shared, name: str, price: Price) -> Iterator[tuple[str, Markup | None]]:
    """Yield a sentence and a figure for each split, condition and role."""
    data, words = shared.data, WORDS[price]
    found = prices_of(shared.records, name, success.name, price)
    groups = grouped(found, lambda r: f"{r.split}\0{price.other(r)}\0{r.role}")
    for key, records in groups.items():
        text = price_sentence(records[0], data.values.metrics[success.name])
        shown = [r for r in records if r.episodes and r.value == r.value]
        if len(shown) < 2 or all(r.note == records[0].note != "" for r in records):
            yield text, None
            continue
        role = key.rpartition("\0")[2]
        yield text, figure_html(
            price_figure(records, data.styles[name]), height=height_of(len(shown)),
            label=f"{price.name.capitalize()} of {name}, {role}s",
            caption=f"To the right of 0 {words.above}. Filled: the interval excludes 0.",
        )  # fmt: skip


def _costs(
    shared: _Shared, name: str
) -> Iterator[tuple[str, list[tuple[str, str, str]], Markup | None]]:
    """Yield the heading, the table and the figure of the costs in each view."""
    for view in shared.views:
        found = shared.costs[view]
        rows = [
            (metric, _text(found[metric][name]), meaning)
            for metric, meaning in MEANINGS.items()
            if name in found.get(metric, {})
        ]
        if not rows:
            continue
        metrics = LATENCIES if name in found.get(LATENCIES[0], {}) else DECISIONS
        title, figure = title_of(view, shared.views), None
        if name in found.get(metrics[0], {}):
            figure = figure_html(
                times_figure(found, metrics, name, shared.data.styles),
                height=height_of(len(found[metrics[0]])), label=f"Times of decisions, {title}",
                caption="Time of a decision: median, and the times that 95 % and 99 % of the"
                f" decisions stay below. In colour: {name}.",
            )  # fmt: skip
        yield title, rows, figure


def _outcomes(shared: _Shared, name: str) -> Iterator[Markup]:
    for view in shared.views:
        rows = {
            scenario: found[name]
            for scenario, found in shared.outcomes[view].items()
            if name in found
        }
        if rows:
            title = title_of(view, shared.views)
            ordered = sorted(rows, key=lambda s: (-rows[s].shares[0], s))
            yield figure_html(
                outcomes_figure({scenario: rows[scenario] for scenario in ordered}),
                height=height_of(len(rows), LINES),
                label=f"Outcomes of {name} by scenario, {title}",
                caption=f"{title}: failures by cause in each scenario.",
            )  # fmt: skip


def _reasons(shared: _Shared, name: str) -> Iterator[tuple[str, list[str]]]:
    """Yield why cells could not be run, and these scenarios and conditions."""
    gaps = [gap for gap in shared.data.values.not_applicable if gap.navigator == name]
    for reason, found in grouped(gaps, lambda gap: gap.reason).items():
        yield (
            reason,
            sorted({f"{gap.scenario} ({condition(gap.track, gap.perception)})" for gap in found}),
        )
