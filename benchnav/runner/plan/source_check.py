"""The check that a worker runs the code whose hash is in the manifest."""

from dataclasses import dataclass, field

from benchnav.errors import RunConflictError
from benchnav.runner.plan.contestant import Contestant, source_of
from benchnav.source.parts import live_object


@dataclass
class SourceCheck:
    """Checks the code of navigators in one process, before the process imports it."""

    _checked: set[str] = field(default_factory=set)  # hashes

    def require_same(self, contestant: Contestant) -> None:
        """Raise RunConflictError if the code of ``entry`` was edited since the run began."""
        known = not contestant.source_hash or contestant.source_hash in self._checked
        if known or any(live_object(place) is not None for place in contestant.places):
            return
        found = source_of(contestant).hash
        if found != contestant.source_hash:
            raise RunConflictError(
                f"The source of {contestant.label!r} must stay as it is until a worker process has"
                f" imported it. It was {contestant.source_hash} when the run began, and is {found}"
                " where this worker runs. All stored episodes are safe; run the same suite again."
            )
        self._checked.add(contestant.source_hash)
