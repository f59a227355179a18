"""The style sheet of the pages of scenarios, navigators and pairs."""

from benchnav.report.page import ASSETS

DETAILS = ASSETS / "details.css"
