"""Success against horizon in every view of one scenario."""

from collections.abc import Iterable, Sequence

from benchnav.leaderboard.statistics.curve import Point, curves_of
from benchnav.report.analysis.episode_summary import EpisodeSummary
from benchnav.report.analysis.view import View


class HorizonCurves:
    """The curves of one scenario. A curve that stands for several tracks is computed once."""

    def __init__(self, summaries: Iterable[EpisodeSummary]) -> None:
        found = list(summaries)
        self._points = curves_of(attempt for s in found for attempt in s.attempts)
        self._tracks: dict[tuple[str, str, str], set[str]] = {}  # by navigator, stored condition
        for s in found:
            for attempt in s.attempts:
                key = s.navigator, attempt.track, attempt.perception
                self._tracks.setdefault(key, set()).update(s.tracks)

    def panels(self, view: View) -> list[Sequence[Point]]:
        """Return the points of each figure of a view; several if horizons or worlds differ."""
        chosen = [
            p
            for p in self._points
            if (p.split, p.perception, p.role) == (view.split, view.perception, view.role)
            and view.track in self._tracks[p.navigator, p.track, p.perception]
        ]
        groups: dict[tuple[str, float, float], list[Point]] = {}
        for p in chosen:
            groups.setdefault((p.scenario_hash, p.horizon, p.dt), []).append(p)
        return list(groups.values())
