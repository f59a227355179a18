"""The result of verifying a run."""

from html import escape

from benchnav.verify.finding import Finding, Report
from benchnav.verify.report_text import report_json, report_text, verdict


class Verification:
    """The result of a verification; true in a condition if it has no findings."""

    def __init__(self, run: str, report: Report, seconds: float) -> None:
        self.run = run
        self.record = report  # the plain record
        self.seconds = seconds  # that it took

    @property
    def verified(self) -> bool:
        """Whether everything that was checked agrees."""
        return self.record.clean

    @property
    def findings(self) -> tuple[Finding, ...]:
        """The disagreements, each with its kind, its place and the stored value."""
        return tuple(self.record.findings)

    def to_json(self) -> str:
        """Return every finding and count as JSON."""
        return report_json(self.run, self.record, self.seconds)

    def text(self) -> str:
        """Return the verdict, the findings, and what was and was not checked, as lines."""
        return report_text(self.run, self.record, self.seconds)

    def __bool__(self) -> bool:
        return self.verified

    def __repr__(self) -> str:
        return f"Verification({verdict(self.run, self.record, self.seconds)})"

    def _repr_html_(self) -> str:
        return f"<pre>{escape(self.text())}</pre>"
