"""What the figures of a report need from one episode."""

from dataclasses import dataclass

from benchnav.episode.episode import Episode


@dataclass(frozen=True, eq=False)
class EpisodeSummary:
    """A stored episode without its trajectories."""

    navigator: str
    scenario: str
    tracks: tuple[str, ...]  # an episode without a map stands for several
    seed: int


def summarise(episode: Episode, tracks: tuple[str, ...]) -> EpisodeSummary:
    """Return the summary of an episode that stands for ``tracks``."""
    identity = episode.identity
    return EpisodeSummary(identity.navigator, identity.scenario, tracks, identity.seed)
