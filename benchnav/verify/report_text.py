"""The report of a verification, as text and as JSON."""

from dataclasses import asdict
from json import dumps

from benchnav.text.columns import columns
from benchnav.text.plural import counted
from benchnav.text.visible import visible
from benchnav.verify.finding import Report

_SHOWN = 40  # findings


def report_json(run: str, report: Report, seconds: float) -> str:
    """Return every finding and count as a JSON object."""
    fields = {
        "run": run, "verified": report.clean, "seconds": round(seconds, 3),
        "findings": [asdict(finding) for finding in report.findings],
        "checked": dict(sorted(report.counts.items())), "not_checked": report.unchecked,
        "versions": report.versions, "sources": report.sources, "caveats": report.caveats,
    }  # fmt: skip
    return dumps(fields, indent=1)


def verdict(run: str, report: Report, seconds: float) -> str:
    """Return one line: whether the run is verified."""
    count = len(report.findings)
    text = "verified" if report.clean else f"NOT verified: {counted(count, 'finding')}"
    return f"{run}: {text}, in {seconds:.1f} s"


def report_text(run: str, report: Report, seconds: float) -> str:
    """Return the verdict, the findings, and what was and was not checked, as lines."""
    count = len(report.findings)
    lines = [verdict(run, report, seconds)]
    if count:
        few = report.few(_SHOWN)
        lines += ["", columns([(f.kind, visible(f.where), visible(f.what)) for f in few])]
        if count > len(few):
            lines.append(f"… and {count - len(few)} more (JSON has all)")
        lines.append("")
    lines += [f"  checked      {visible(text)}" for text in report.checked]
    lines += [f"  not checked  {visible(text)}" for text in report.unchecked]
    lines += [f"  source       {visible(text)}" for text in report.sources]
    lines += [f"  note         {visible(text)}" for text in (*report.versions, *report.caveats)]
    return "\n".join(lines)
