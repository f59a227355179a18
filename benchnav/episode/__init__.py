"""The record of one run of one navigator in one world. Names are loaded at their first use."""

from typing import TYPE_CHECKING

from benchnav.lazy_names import lazy_names

if TYPE_CHECKING:
    from benchnav.episode.episode import Contacts, Episode, Identity, Status, Timings
else:
    __getattr__ = lazy_names(
        __name__,
        {
            "Contacts": "benchnav.episode.episode",
            "Episode": "benchnav.episode.episode",
            "Identity": "benchnav.episode.episode",
            "Status": "benchnav.episode.episode",
            "Timings": "benchnav.episode.episode",
        },
    )

__all__ = [
    "Contacts",
    "Episode",
    "Identity",
    "Status",
    "Timings",
]
