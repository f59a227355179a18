"""Leaderboard tables with intervals and ties; entries that are not comparable are not ranked."""

from benchnav.leaderboard.record import Leaderboard, NotApplicable, Record
from benchnav.leaderboard.rendering.formats import render
from benchnav.leaderboard.statistics.comparison import Comparison
from benchnav.leaderboard.statistics.paired import comparisons
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
