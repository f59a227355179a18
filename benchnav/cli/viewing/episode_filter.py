"""The options of `benchnav replay` that choose episodes."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

from benchnav.errors import UsageError
from benchnav.text.plural import counted

if TYPE_CHECKING:
    from benchnav.api.records.episodes import Episodes
    from benchnav.api.records.run import Run


@dataclass(frozen=True, kw_only=True)
class EpisodeFilter:
    """The chosen values; None or an empty tuple: all."""

    navigators: tuple[str, ...]
    scenario: str | None
    track: str | None
    perception: str | None
    seed: int | None
    failed: bool | str  # or one of `benchnav.report.failed_episodes.CAUSES`
    worst: str | None

    @property
    def options(self) -> list[str]:
        """The options that were given."""
        given = {
            "--navigator": bool(self.navigators), "--scenario": self.scenario is not None,
            "--track": self.track is not None, "--perception": self.perception is not None,
            "--seed": self.seed is not None,
            "--failed": self.failed is True, "--cause": isinstance(self.failed, str),
            "--worst": self.worst is not None,
        }  # fmt: skip
        return [option for option, is_given in given.items() if is_given]

    def require_unused(self, episodes: list[str], *, lists: bool) -> None:
        """Raise UsageError if ``episodes`` are named and chosen by options as well."""
        from benchnav.report.failed_episodes import CAUSES

        for name in episodes:
            if name in CAUSES:
                raise UsageError(f"{name!r} is not an episode. Write --cause {name} instead.")
        options = [*self.options, "--list"] if lists else self.options
        if options:
            raise UsageError(
                "Name episodes, or choose them with options, not both."
                f" Got {episodes[0]!r} and {', '.join(options)}."
            )

    def all_of(self, run: "Run") -> "Episodes":
        """Return the chosen episodes of all chosen navigators."""
        from benchnav.api.records.episodes import Episodes

        found = [self._of(run, navigator) for navigator in self.navigators or (None,)]
        if len(found) == 1:
            return found[0]
        return Episodes([place for episodes in found for place in episodes.places], run)

    def first_of(self, run: "Run") -> "Episodes":
        """Return the first chosen episode, and those of the other navigators in the same world.

        Raises UsageError if there is none.
        """
        from benchnav.api.records.episode_choice import failed_episodes, in_same_world

        navigators = list(self.navigators)
        found = self._of(run, navigators[0] if navigators else None)
        if not len(found):
            raise UsageError(self.why_none(run))
        if not self.failed and self.worst is None and self.seed is None:
            found = failed_episodes(run.folder, found.places, run)[:1] or found
        if len(navigators) > 1:
            return in_same_world(run.folder, found.places[0], navigators, run)
        return found[:1]

    def why_none(self, run: "Run") -> str:
        """Return why no episode was found."""
        values = {
            "navigator": " or ".join(self.navigators) or None, "scenario": self.scenario,
            "track": self.track, "perception": self.perception, "seed": self.seed,
        }  # fmt: skip
        names = ", ".join(f"{key} {value}" for key, value in values.items() if value is not None)
        named = f" of {names}" if names else ""
        first = self.navigators[0] if self.navigators else None
        count = len(
            run.episodes(first, self.scenario, self.track, self.seed, perception=self.perception)
        )
        if not count:
            shown = f"'benchnav replay {run.path} --list' shows all episodes."
            return f"{run.path} holds no episode{named}. {shown}"
        among = f"{counted(count, 'stored episode')}{named}"
        if isinstance(self.failed, str):
            return f"No agent failed with the cause {self.failed!r} in {among}."
        if self.failed:
            return f"All agents succeeded in {among}."
        return f"The metric {self.worst!r} is defined in none of {among}."

    def _of(self, run: "Run", navigator: str | None) -> "Episodes":
        return run.episodes(
            navigator,
            self.scenario,
            self.track,
            self.seed,
            perception=self.perception,
            failed=self.failed,
            worst=self.worst,
        )
