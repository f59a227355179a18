"""The stored episodes of a run, or some of them."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, NamedTuple, overload

from benchnav.api.output.text_table import table_html
from benchnav.api.records.episode import Episode
from benchnav.errors import UsageError, did_you_mean
from benchnav.leaderboard.from_runs import matching_scenarios
from benchnav.scenario.condition import EXACT, episode_name, perception_of
from benchnav.scenario.terms import TRACKS
from benchnav.store.parts.part import Part
from benchnav.store.runs.run_folder import RunFolder
from benchnav.text.plural import counted
from benchnav.verify.stored_origin import stored_origin

if TYPE_CHECKING:
    import pandas as pd

    from benchnav.api.records.replay import Replay

_SHOWN = 20  # rows in a notebook


class Place(NamedTuple):
    """Where one episode is stored, and as what it counts."""

    part: Part
    navigator: str
    scenario: str
    track: str
    seed: int
    folder: RunFolder
    perception: str = EXACT

    @property
    def name(self) -> str:
        """NAVIGATOR/SCENARIO/TRACK/SEED; before the seed the perception, unless it is exact."""
        return episode_name(self.navigator, self.scenario, self.track, self.perception, self.seed)


class Episodes(Sequence[Episode]):
    """A sequence that reads an episode when it is used, in the order of the suite, by seed."""

    def __init__(self, places: Sequence[Place], owner: object = None) -> None:
        self._places = tuple(places)
        self._owner = owner  # the run, whose files stay there as long as it does

    @property
    def places(self) -> tuple[Place, ...]:
        """The place of each episode: nothing is read for it."""
        return self._places

    def __len__(self) -> int:
        return len(self._places)

    @overload
    def __getitem__(self, index: int) -> Episode: ...

    @overload
    def __getitem__(self, index: slice) -> "Episodes": ...

    def __getitem__(self, index: "int | slice") -> "Episode | Episodes":
        if isinstance(index, slice):
            return Episodes(self._places[index], self._owner)
        return next(_read([self._places[index]]))

    def __iter__(self) -> Iterator[Episode]:
        """Read the episodes one after another; a file is read once for all that are wanted."""
        group: list[Place] = []
        for place in self._places:
            if group and (place.part, place.track) != (group[0].part, group[0].track):
                yield from _read(group)
                group = []
            group.append(place)
        yield from _read(group)

    def to_pandas(self) -> "pd.DataFrame":
        """Return the trajectories of all.

        The first columns are navigator, scenario, track, perception, seed. The other columns are
        those of `Episode.to_pandas`.
        """
        import pandas as pd

        frames = [
            episode.to_pandas().assign(
                navigator=episode.navigator, scenario=episode.scenario, track=episode.track,
                perception=episode.perception, seed=episode.seed,
            )
            for episode in self
        ]  # fmt: skip
        if not frames:
            return pd.DataFrame(columns=[*_KEYS, *_STATES])
        return pd.concat(frames, ignore_index=True)[[*_KEYS, *_STATES]]

    def replay(self, agents: "Sequence[int] | None" = None) -> "Replay":
        """Return a replay of all of them side by side: at most nine.

        Args:
            agents: those whose sensor readings and charts it holds; None: up to four, first those
                that did not succeed.
        """
        from benchnav.api.records.replay import MOST, Replay

        if not self:
            raise UsageError("A replay needs an episode. The choice holds none: choose others.")
        return Replay.of(self[: MOST + 1], agents)

    def __repr__(self) -> str:
        navigators = dict.fromkeys(place.navigator for place in self._places)
        scenarios = dict.fromkeys(place.scenario for place in self._places)
        return (
            f"Episodes({len(self)}: {counted(len(navigators), 'navigator')},"
            f" {counted(len(scenarios), 'scenario')})"
        )

    def _repr_html_(self) -> str:
        rows = [
            (place.navigator, place.scenario, place.track, place.perception, str(place.seed))
            for place in self._places[:_SHOWN]
        ]
        more = len(self) - len(rows)
        title = f"{counted(len(self), 'episode')}" + (f", the first {len(rows)}" if more else "")
        return table_html(title, _KEYS, rows)


_KEYS = ("navigator", "scenario", "track", "perception", "seed")
_STATES = ("time", "agent", "x", "y", "heading", "vx", "vy", "status")


def stored_episodes(
    folder: RunFolder,
    navigator: str | None,
    scenario: str | None,
    track: str | None,
    perception: str | None,
    seed: int | None,
    owner: object = None,
) -> Episodes:
    """Return the episodes of a run that are named; None: of all. They keep ``owner`` alive.

    Raises UsageError for a name that the run does not have.
    """
    cells = [cell for cell in folder.manifest.cells if not cell["reason"]]
    # undisturbed episodes are hidden unless they are named
    cells = [cell for cell in cells if navigator or not folder.manifest.is_undisturbed(cell)]
    _require("navigator", navigator, [cell["navigator"] for cell in folder.manifest.cells])
    tracks = [t for cell in folder.manifest.cells for t in (*cell.get("also", ()), cell["track"])]
    # 'unknown' is no misspelt 'known': it was not run.
    _require("track", track, tracks, hint=track not in TRACKS)
    _require("perception", perception, [*map(perception_of, folder.manifest.cells)])
    known = {cell["scenario"] for cell in folder.manifest.cells}
    scenarios = known if scenario is None else matching_scenarios(known, [scenario])
    places = [
        Place(part, cell["navigator"], cell["scenario"], each, s, folder, perception_of(cell))
        for cell in cells
        if navigator in (None, cell["navigator"]) and cell["scenario"] in scenarios
        if perception in (None, perception_of(cell))
        for each in (*cell.get("also", ()), cell["track"])
        if track in (None, each)
        for part in folder.parts_in(cell)
        for s in part.seeds
        if seed in (None, s)
    ]
    return Episodes(places, owner)


def _read(places: Sequence[Place]) -> Iterator[Episode]:
    """The episodes of one part that are wanted, in the order of their seeds."""
    wanted = {place.seed: place for place in places}
    if not wanted:
        return
    for record in places[0].part.episodes():
        place = wanted.get(record.identity.seed)
        if place is not None:
            shown = replace(record, identity=replace(record.identity, track=place.track))
            yield Episode(shown, partial(stored_origin, place.folder, place.part, record))


def _require(what: str, name: str | None, known: Sequence[str], *, hint: bool = True) -> None:
    every = list(dict.fromkeys(known))
    if name is not None and name not in every:
        raise UsageError(
            f"The {what} must be one that was run: {', '.join(every)}. Got {name!r} instead."
            f"{did_you_mean(name, every) if hint else ''}"
        )
