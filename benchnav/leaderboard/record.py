"""One number of a leaderboard, with the data needed to judge it."""

import math
from dataclasses import dataclass, field
from typing import Any, Literal

ALL = "all"
"""Replaces a scenario: the mean over scenarios."""
ALL_INTERQUARTILE = "all (interquartile mean)"
"""Replaces a scenario: the interquartile mean over scenarios."""
NO_MAP = "uses no map"
"""The note of a price that is 0 because the navigator uses no map."""
OPTIONAL = {"optional": True}
"""The metadata of a field that CSV and JSON leave out if no record has it."""


@dataclass(frozen=True)
class Price:
    """A loss of the same navigators in the same worlds: a paired difference, which never ranks."""

    name: str
    axis: Literal["track", "perception"]
    first: str  # a value of the axis: the difference is first − second
    second: str

    @property
    def mark(self) -> str:
        """The text that replaces the value of the axis in a record."""
        return f"{self.first} - {self.second}"

    def other(self, of: Any) -> str:
        """Return the value of the other axis: of a stratum, a record or a cell."""
        return str(of.perception if self.axis == "track" else of.track)

    def place_of(self, of: Any) -> tuple[str, str]:
        """Return track and perception of its records, one of which is the mark."""
        other = self.other(of)
        return (self.mark, other) if self.axis == "track" else (other, self.mark)

    def sides(self, of: Any) -> tuple[tuple[str, str], tuple[str, str]]:
        """Return the track and perception of both sides."""
        other = self.other(of)
        if self.axis == "track":
            return (self.first, other), (self.second, other)
        return (other, self.first), (other, self.second)


IGNORANCE = Price("price of ignorance", "track", "known", "unknown")
NOISE = Price("price of noise", "perception", "exact", "noisy")
PRICES = (IGNORANCE, NOISE)


@dataclass(frozen=True)
class NotApplicable:
    """A cell that cannot be run: a navigator whose needs the track does not meet."""

    navigator: str
    scenario: str
    track: str
    reason: str  # "needs a map"
    rehearsal: int = 0  # rehearsals that it requests
    perception: str = "exact"


@dataclass(frozen=True, kw_only=True)
class Record:
    """One navigator × scenario × track × perception × role × metric."""

    navigator: str
    scenario: str  # "leaders/dynamic@1", ALL, or ALL_INTERQUARTILE
    track: str  # or the mark of `IGNORANCE`
    perception: str = "exact"  # or the mark of `NOISE`
    role: str
    metric: str
    value: float  # mean over episodes; NaN if no episode defines it
    low: float  # of the 95 % interval; NaN if the episodes give none
    high: float
    unit: str
    better: Literal["higher", "lower"] | None
    episodes: int  # attempted
    defined: int  # episodes with a value (failed ones counted as failures)
    failures: int  # episodes in which the navigator failed
    rank_low: int | None  # 1 + entries that are significantly better; None if not ranked
    rank_high: int | None  # N − entries that are significantly worse
    ranked: int  # N, number of entries ranked together; 0 if not ranked
    note: str  # reason for no rank or no value; "" if it is ranked
    split: str
    scenario_hash: str  # "" for aggregates over scenarios
    horizon: float  # [s]; NaN for aggregates
    dt: float  # [s]; NaN for aggregates
    training_decisions: float = math.nan  # decisions of training; NaN without training
    training_seconds: float = math.nan  # duration of training
    rehearsal: int = 0  # rehearsals of each world that the navigator was granted
    rehearsal_decisions: float = math.nan  # in rehearsals, mean over worlds; NaN without a grant
    rehearsal_seconds: float = math.nan  # of the leading navigator, mean over worlds
    mode: str = ""  # "in-process" or "isolated"; "" if the runs are unknown
    fault: str = ""  # number of failures of the metric, and the reason; "" for none
    failure: str = ""  # number of worlds in which the navigator failed, and why; "" for none
    remark: str = ""  # the navigator's remarks, and their number of episodes; "" for none
    verified: bool = False  # its runs were verified here, and it is not a timing
    caveat: str = ""  # caveats about its runs; "" for none
    trainings: int = field(default=1, metadata=OPTIONAL)  # with different seeds, if several
    training_least: float = field(default=math.nan, metadata=OPTIONAL)  # mean of a training
    training_most: float = field(default=math.nan, metadata=OPTIONAL)
    training_deviation: float = field(default=math.nan, metadata=OPTIONAL)  # standard (n − 1)

    @property
    def price(self) -> Price | None:
        """The price that it is a value of; None for a result."""
        return next((p for p in PRICES if getattr(self, p.axis) == p.mark), None)


@dataclass(frozen=True)
class Leaderboard:
    """Tidy records, sorted; each group of comparable episodes is contiguous."""

    records: tuple[Record, ...]
    metrics: tuple[str, ...]  # every metric that occurs, in the order of the definitions
    caveats: tuple[str, ...] = ()  # caveats of the runs, shown below all tables

    @property
    def navigators(self) -> tuple[str, ...]:
        """Every navigator that occurs, sorted."""
        return tuple(sorted({record.navigator for record in self.records}))
