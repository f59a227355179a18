"""Recordings of people in the formats of other projects, and scenarios made from them."""

from benchnav.scenario.importers.recording.draft import Request, import_recording
from benchnav.scenario.importers.recording.formats import FORMATS, find_format

__all__ = ["FORMATS", "Request", "find_format", "import_recording"]
