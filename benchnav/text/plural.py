"""Counts with a noun in singular or plural."""


def counted(count: int, noun: str) -> str:
    """Return ``1 world`` or ``2 worlds``, for nouns with a plural in s."""
    return f"{count} {noun}{'' if count == 1 else 's'}"
