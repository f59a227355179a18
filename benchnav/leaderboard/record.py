"""One number of a leaderboard, with everything that is needed to judge it."""

import math
from dataclasses import dataclass
from typing import Literal

ALL = "all"
"""Stands where a scenario stands: the mean over scenarios."""
ALL_INTERQUARTILE = "all (interquartile mean)"
"""Stands where a scenario stands: the interquartile mean over scenarios."""
PRICE = "known - unknown"
"""Stands where a track stands: the price of ignorance, a paired difference. It never ranks."""
NO_MAP = "uses no map"
"""The note of a price that is 0 because nothing can differ."""


@dataclass(frozen=True)
class NotApplicable:
    """A cell that cannot be run: a navigator that needs what the track does not give."""

    navigator: str
    scenario: str
    track: str
    reason: str  # "needs a map"
    rehearsal: int = 0  # rehearsals that it asks for


@dataclass(frozen=True)
class Record:
    """One navigator × scenario × track × role × metric."""

    navigator: str
    scenario: str  # "leaders/dynamic@1", ALL, or ALL_INTERQUARTILE
    track: str
    role: str
    metric: str
    value: float  # mean over episodes; NaN where no episode defines it
    low: float  # of the 95 % interval; NaN where the episodes give none
    high: float
    unit: str
    better: Literal["higher", "lower"] | None
    episodes: int  # attempted
    defined: int  # of them with a value (after failed ones were counted as failures)
    failures: int  # of them in which the navigator failed
    rank_low: int | None  # 1 + entries that are significantly better; None if not ranked
    rank_high: int | None  # N − entries that are significantly worse
    ranked: int  # N, how many entries were ranked together; 0 if not ranked
    note: str  # why it is not ranked, or why there is no value; "" if it is ranked
    split: str
    scenario_hash: str  # "" for aggregates over scenarios
    horizon: float  # [s]; NaN for aggregates
    dt: float  # [s]; NaN for aggregates
    training_decisions: float = math.nan  # that the navigator learned from; NaN if it did not
    training_seconds: float = math.nan  # that this took
    rehearsal: int = 0  # rehearsals of each world that the navigator was granted
    rehearsal_decisions: float = math.nan  # in them, mean over worlds; NaN without a grant
    rehearsal_seconds: float = math.nan  # of the navigator that led, mean over worlds
    mode: str = ""  # "in-process" or "isolated"; "" where the runs are not known
    fault: str = ""  # where and how the metric failed; "" if it did not
    failure: str = ""  # in how many worlds the navigator failed, and why; "" if it did not
    remark: str = ""  # what the navigator tells of its episodes, and of how many; "" if nothing
    verified: bool = False  # its runs were verified here, and it is no timing
    caveat: str = ""  # where its runs are not what their names say here; "" if they are


@dataclass(frozen=True)
class Leaderboard:
    """Tidy records, sorted; each group of episodes that may be compared stands together."""

    records: tuple[Record, ...]
    metrics: tuple[str, ...]  # every metric that occurs, in the order of the definitions
    caveats: tuple[str, ...] = ()  # what must be known of the runs, for below all tables

    @property
    def navigators(self) -> tuple[str, ...]:
        """Every navigator that occurs, sorted."""
        return tuple(sorted({record.navigator for record in self.records}))
