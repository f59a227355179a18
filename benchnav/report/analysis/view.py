"""The views of results: a split, a track, a role and a perception, which are never mixed."""

from collections.abc import Collection, Iterable
from dataclasses import dataclass

from benchnav.leaderboard.record import Record
from benchnav.scenario.condition import EXACT, described
from benchnav.scenario.terms import PERCEPTIONS, SPLITS, TRACKS

ROLES = ("leader", "follower")


@dataclass(frozen=True)
class View:
    """A set of results that share a split, a track, a role and a perception."""

    split: str
    track: str
    role: str
    perception: str = EXACT

    def holds(self, record: Record) -> bool:
        """Whether a record belongs to this view."""
        return view_of(record) == self


def view_of(record: Record) -> View:
    """Return the view of a record."""
    return View(record.split, record.track, record.role, record.perception)


def views_of(records: Iterable[Record]) -> list[View]:
    """Return the views of some records, in the order of tracks; without prices."""
    found = {view_of(r) for r in records if not r.price}
    return sorted(found, key=_place)


def _place(view: View) -> tuple[int, int, int, int]:
    condition = TRACKS.index(view.track), PERCEPTIONS.index(view.perception)
    return SPLITS.index(view.split), *condition, ROLES.index(view.role)


def title_of(view: View, others: Collection[View]) -> str:
    """Return the heading of a view: its condition, and what distinguishes it from the others."""
    parts = [described(view.track, view.perception).capitalize()]
    if len({v.role for v in others}) > 1 or view.role != ROLES[0]:
        parts.append(f"{view.role}s")
    if len({v.split for v in others}) > 1 or view.split != "test":
        parts.append(f"split {view.split}")
    return ", ".join(parts)
