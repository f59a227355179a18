"""The check that a worker runs the code whose hash is in the manifest."""

from dataclasses import dataclass, field

from benchnav.errors import RunConflictError
from benchnav.runner.plan.contestant import Entry, source_of
from benchnav.source.parts import live_object


@dataclass
class SourceCheck:
    """Checks the code of navigators in one process, before the process imports it."""

    _checked: set[str] = field(default_factory=set)  # hashes

    def require_same(self, entry: Entry) -> None:
        """Raise RunConflictError if the code of ``entry`` was edited since the run began."""
        known = not entry.source_hash or entry.source_hash in self._checked
        if known or any(live_object(place) is not None for place in entry.places):
            return
        found = source_of(entry).hash
        if found != entry.source_hash:
            raise RunConflictError(
                f"The source of {entry.label!r} must stay as it is until a worker process has"
                f" imported it. It was {entry.source_hash} when the run began, and is {found}"
                " where this worker runs. All stored episodes are safe; run the same suite again."
            )
        self._checked.add(entry.source_hash)
