"""Success against the parameters of scenarios that were run with several values."""

from collections.abc import Sequence

from benchnav.leaderboard.from_runs import StoredValues, settings_of
from benchnav.leaderboard.statistics.curve import Point, Setting, parameter_curves
from benchnav.metrics.success import success
from benchnav.report.analysis.view import View
from benchnav.store.runs.run_folder import RunFolder


class ParameterCurves:
    """The curves of success against each parameter that has several values."""

    def __init__(self, folders: Sequence[RunFolder], values: StoredValues) -> None:
        self._settings: dict[str, dict[str, Setting]] = {}  # axis → scenario → setting
        self._points: dict[str, tuple[Point, ...]] = {}
        for axis in _axes(folders):
            settings = _several(settings_of(folders, axis))
            if settings and success.name in values.names:
                self._settings[axis] = settings
                self._points[axis] = parameter_curves(values.results, success, axis, settings)

    def panels(self, scenario: str, view: View) -> list[list[Point]]:
        """Return the points of each figure that contains a scenario, in one view."""
        found = []
        for axis, settings in self._settings.items():
            if scenario not in settings:
                continue
            chosen = [
                p
                for p in self._points[axis]
                if p.scenario == settings[scenario].scenario
                and View(p.split, p.track, p.role, p.perception) == view
            ]
            if len({p.x for p in chosen}) > 1:
                found.append(chosen)
        return found


def _axes(folders: Sequence[RunFolder]) -> list[str]:
    """Return every parameter that a scenario of the runs declares."""
    entries = (e for folder in folders for e in folder.manifest.suite["scenarios"])
    return list(dict.fromkeys(axis for e in entries for axis in e["config"].get("parameters", {})))


def _several(settings: dict[str, Setting]) -> dict[str, Setting]:
    """Return the settings of scenarios that differ only in this parameter."""
    values: dict[str, set[float]] = {}
    for setting in settings.values():
        values.setdefault(setting.scenario, set()).add(setting.x)
    return {name: each for name, each in settings.items() if len(values[each.scenario]) > 1}
