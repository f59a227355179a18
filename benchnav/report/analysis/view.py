"""The views of results: a split, a track and a role, which are never mixed."""

from collections.abc import Collection, Iterable
from dataclasses import dataclass

from benchnav.leaderboard.record import PRICE, Record
from benchnav.scenario.terms import SPLITS, TRACKS

_ROLES = ("leader", "follower")


@dataclass(frozen=True)
class View:
    """A set of results that share a split, a track and a role."""

    split: str
    track: str
    role: str

    def holds(self, record: Record) -> bool:
        """Whether a record belongs to this view."""
        return (record.split, record.track, record.role) == (self.split, self.track, self.role)


def view_of(record: Record) -> View:
    """Return the view of a record."""
    return View(record.split, record.track, record.role)


def views_of(records: Iterable[Record]) -> list[View]:
    """Return the views of some records, in the order of tracks; without the price of ignorance."""
    found = {view_of(r) for r in records if r.track != PRICE}
    return sorted(found, key=_place)


def _place(view: View) -> tuple[int, int, int]:
    return SPLITS.index(view.split), TRACKS.index(view.track), _ROLES.index(view.role)


def title_of(view: View, others: Collection[View]) -> str:
    """Return the heading of a view: its track, and what distinguishes it from the others."""
    parts = [f"Track {view.track}"]
    if len({v.role for v in others}) > 1 or view.role != _ROLES[0]:
        parts.append(f"{view.role}s")
    if len({v.split for v in others}) > 1 or view.split != "test":
        parts.append(f"split {view.split}")
    return ", ".join(parts)
