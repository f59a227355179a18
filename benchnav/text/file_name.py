"""Names of files that every system allows."""

MOST = 120  # characters before the suffix


def file_name(*words: str, suffix: str) -> str:
    """Return ``words`` joined by hyphens, with letters, digits, `-`, `_` and `.` alone."""
    text = "-".join(words)
    return "".join(c if c.isalnum() or c in "-_." else "-" for c in text)[:MOST] + suffix
