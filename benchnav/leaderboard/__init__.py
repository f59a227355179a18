"""Tables that refuse to mislead: intervals, ties, and no ranking of what cannot be compared."""

from benchnav.leaderboard.comparison import Comparison
from benchnav.leaderboard.paired import comparisons
from benchnav.leaderboard.record import Leaderboard, NotApplicable, Record
from benchnav.leaderboard.render import render
from benchnav.leaderboard.table import leaderboard

__all__ = [
    "Comparison",
    "Leaderboard",
    "NotApplicable",
    "Record",
    "comparisons",
    "leaderboard",
    "render",
]
