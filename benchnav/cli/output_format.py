"""The format of a result: from --format, or from the name of the file that it goes to."""

from collections.abc import Sequence
from pathlib import Path

from benchnav.errors import UsageError, did_you_mean

SUFFIXES = {
    ".md": "markdown", ".markdown": "markdown", ".csv": "csv", ".tex": "latex", ".html": "html",
    ".htm": "html", ".json": "json",
}  # fmt: skip


def out_format(
    formats: Sequence[str], format: str | None, out: Path | None, pictures: Sequence[str] = ()
) -> str:
    """Return the format of ``formats`` to write; by default the first one.

    The suffix of a file that ends in one of ``pictures`` has no influence, because text then goes
    to stdout. Raises UsageError for an unknown format, for a suffix without a format, and if
    ``format`` and the suffix of ``out`` disagree.
    """
    if format is not None and format not in formats:
        raise UsageError(
            f"--format must be one of {', '.join(formats)}. Got {format!r} instead."
            f"{did_you_mean(format, formats)}"
        )
    suffix = "" if out is None else out.suffix.lower()
    if out is None or suffix in pictures or (not suffix and format is not None):
        return format or formats[0]
    known = {end: name for end, name in SUFFIXES.items() if name in formats}
    if suffix not in known:
        ends = [f"{end} ({name})" for end, name in known.items()] + list(pictures)
        raise UsageError(
            f"--out must end in one of {', '.join(ends)}. Got {out} instead."
            f"{did_you_mean(suffix, [*known, *pictures])}"
        )
    if format not in (None, known[suffix]):
        raise UsageError(
            f"--format and --out must agree. Got --format {format}, and --out {out}, which ends"
            f" as {known[suffix]} does. Leave one of them out, or change it."
        )
    return known[suffix]
