"""The list of scenarios, and a page for each of them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import PurePosixPath
from typing import TYPE_CHECKING

from benchnav.leaderboard.record import Record
from benchnav.metrics.success import success
from benchnav.report.analysis.episode_summary import EpisodeSummary, variant_name
from benchnav.report.analysis.failures import outcome_shares, partners
from benchnav.report.analysis.horizon import HorizonCurves
from benchnav.report.analysis.parameter import ParameterCurves
from benchnav.report.analysis.partner import fixed_obstacles
from benchnav.report.analysis.scenario_facts import scenario_facts
from benchnav.report.analysis.view import View, title_of, views_of
from benchnav.report.figure import figure_html
from benchnav.report.figures.curves import curves_figure, parameter_figure
from benchnav.report.figures.failures import LINES, outcomes_figure, partners_figure
from benchnav.report.figures.intervals import by_value, intervals_figure
from benchnav.report.figures.style import height_of
from benchnav.report.figures.world import Hit, hits_text, world_picture
from benchnav.report.line_style import LineStyle
from benchnav.report.page import LEADERBOARD, SCENARIOS, Page, scenario_path
from benchnav.report.pages.grouping import grouped
from benchnav.report.pages.records import records_with
from benchnav.report.pages.table import metric_table
from benchnav.report.report_data import ReportData, StoredScenario
from benchnav.report.template import fill
from benchnav.scenario.condition import described

if TYPE_CHECKING:
    from markupsafe import Markup

MOST_PARTNERS = 12  # rows of the figure of obstacles
SHOWN = 6  # metrics of a table
TALL = 420  # [px] of a curve without its legend
SUCCESS = "Success: share of agents that arrive without a collision. Mean and 95 % interval."
CURVES = (
    "Success against horizon: share of all agents that would have succeeded had the episodes ended"
    " by then."
)
CAUSES = "Failures by cause. An agent that collides and goes on counts as a collision."
PARTNERS = (
    "Collisions by obstacle: the first collision of each agent. Numbers are those in the pictures;"
    " obstacles that are drawn anew for each seed are added up."
)


def pages(data: ReportData) -> Iterator[Page]:
    """Yield the page with all scenarios, then one for each."""
    records = grouped(records_with(data, (success.name,)), lambda r: r.scenario)
    summaries = grouped(data.summaries, lambda s: s.scenario)
    curves = ParameterCurves(data.folders, data.values)
    found = [
        _Scenario(data, each, records.get(name, []), summaries.get(name, []), curves)
        for each in data.scenarios
        for name in [each.identity]
    ]
    cards = [
        {"scenario": each.scenario, "picture": next(iter(each.pictures), None), "best": each.best}
        for each in found
    ]  # fmt: skip
    yield Page(
        SCENARIOS,
        "Scenarios",
        fill(
            "scenarios.html",
            page=SCENARIOS,
            cards=cards,
            leaderboard=LEADERBOARD,
            styles=_styles(data, data.summaries),
        ),
        SCENARIOS,
    )
    for each in found:
        yield each.page()


def _styles(data: ReportData, summaries: Iterable[EpisodeSummary]) -> dict[str, LineStyle]:
    """Return the styles of the navigators whose collisions the pictures show."""
    hit = {s.navigator for s in summaries if s.collisions}
    return {name: style for name, style in data.styles.items() if name in hit}


@dataclass(frozen=True, eq=False)
class _Scenario:
    """A scenario with its results."""

    data: ReportData
    scenario: StoredScenario
    records: Sequence[Record]
    summaries: Sequence[EpisodeSummary]
    parameters: ParameterCurves

    @property
    def best(self) -> list[str]:
        """The highest success in each view, in words."""
        texts, views = [], views_of(self.records)
        for view in views:
            ordered = by_value([r for r in self._of(view, success.name) if r.value == r.value])
            if ordered:
                title = title_of(view, views)
                texts.append(f"{title}: {ordered[0].navigator} {ordered[0].value:.2f}")
        return texts

    @cached_property
    def fixed(self) -> set[str]:
        """The obstacles and walls that are the same in all stored worlds."""
        return fixed_obstacles(self.scenario.worlds) if self.scenario.worlds else set()

    @property
    def _path(self) -> PurePosixPath:
        return scenario_path(self.scenario.identity)

    def page(self) -> Page:
        """Return the page of the scenario."""
        path = self._path
        config = self.scenario.config
        body = fill(
            "scenario.html",
            page=path,
            scenario=self.scenario,
            styles=_styles(self.data, self.summaries),
            title=str(config.get("title", "")),
            description=str(config.get("description", "")),
            facts=scenario_facts(config, self.scenario.worlds, self.scenario.hash),
            pictures=[
                (seed, picture, hits_text(len(self._hits(seed))))
                for seed, picture in zip(self.scenario.seeds, self.pictures, strict=True)
            ],
            sections=[s for title, each in self._variants() for s in each._sections(title)],
        )
        return Page(path, self.scenario.identity, body, SCENARIOS, has_figures=True)

    def _variants(self) -> Iterator[tuple[str, _Scenario]]:
        """Yield the results of equal hash, horizon and time step, and what distinguishes them."""
        found = grouped(self.records, lambda r: variant_name(r.scenario_hash, r.horizon, r.dt))
        summaries = grouped(self.summaries, lambda s: s.variant)
        if len(found) < 2:
            yield "", self
            return
        for title, records in found.items():
            yield title, replace(self, records=records, summaries=summaries.get(title, []))

    def _sections(self, title: str) -> Iterator[tuple[str, list[Markup], Markup]]:
        """Yield heading, figures and table of each view."""
        views = views_of(self.records)
        for view in views:
            parts = (title_of(view, views), title)
            yield ", ".join(filter(None, parts)), *self._section(view)

    @cached_property
    def pictures(self) -> list[Markup]:
        """The pictures of the stored worlds."""
        names = self.fixed & {hit.partner for s in self.summaries for hit in s.collisions}
        return [
            world_picture(world, self._hits(seed), names, self.data.styles)
            for world, seed in zip(self.scenario.worlds, self.scenario.seeds, strict=True)
        ]

    def _hits(self, seed: int) -> list[Hit]:
        return [
            (s.navigator, hit) for s in self.summaries if s.seed == seed for hit in s.collisions
        ]

    def _section(self, view: View) -> tuple[list[Markup], Markup]:
        """Return the figures and the table of one view."""
        condition = described(view.track, view.perception)
        where = f"{self.scenario.identity}, {condition}, {view.role}s"
        values = self._of(view, success.name)
        figures = []
        if any(r.value == r.value for r in values):
            figures.append(figure_html(
                intervals_figure(values, self.data.styles), height=height_of(len(values)),
                label=f"Success of each navigator in {where}",
                caption=SUCCESS,
            ))  # fmt: skip
        figures += [*self._curves(view, where), *self._failures(view, where)]
        figures += self._parameters(view, where)
        shown = [m for m in self.data.metrics if m in self.data.values.metrics][:SHOWN]
        chosen = [r for r in self.records if view.holds(r)]
        return figures, metric_table(self._path, chosen, shown, self.data)

    @cached_property
    def _horizon(self) -> HorizonCurves:
        return HorizonCurves(self.summaries)

    def _curves(self, view: View, where: str) -> Iterator[Markup]:
        """Yield the figure of success against horizon; several if horizons differ."""
        for points in self._horizon.panels(view):
            names = {p.navigator for p in points}
            yield figure_html(
                curves_figure(points, self.data.styles), height=TALL + 12 * len(names),
                label=f"Success against horizon in {where}",
                caption=CURVES,
            )  # fmt: skip

    def _parameters(self, view: View, where: str) -> Iterator[Markup]:
        """Yield the figures of success against each parameter with several values."""
        for points in self.parameters.panels(self.scenario.identity, view):
            names, axis = {p.navigator for p in points}, points[0].axis
            yield figure_html(
                parameter_figure(points, self.data.styles), height=TALL + 12 * len(names),
                label=f"Success against {axis} in {where}",
                caption=f"Success against the parameter {axis} of {points[0].scenario}.",
            )  # fmt: skip

    def _failures(self, view: View, where: str) -> Iterator[Markup]:
        """Yield the figures of failures by cause and by obstacle."""
        shares = outcome_shares(self.summaries, view).get(self.scenario.identity, {})
        ordered = sorted(shares, key=lambda name: (-shares[name].shares[0], name))
        if ordered:
            yield figure_html(
                outcomes_figure({name: shares[name] for name in ordered}),
                height=height_of(len(ordered), LINES), label=f"Outcomes of agents in {where}",
                caption=CAUSES,
            )  # fmt: skip
        found = partners(self.summaries, view, MOST_PARTNERS, self.fixed)
        if found:
            yield figure_html(
                partners_figure(found, self.data.styles),
                height=height_of(len(found), 2 + len(shares) // 2),
                label=f"Obstacles, walls and agents that were hit in {where}",
                caption=PARTNERS,
            )  # fmt: skip

    def _of(self, view: View, metric: str) -> list[Record]:
        return [r for r in self.records if view.holds(r) and r.metric == metric]
