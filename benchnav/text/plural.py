"""Counts of things in words."""


def counted(count: int, noun: str) -> str:
    """Return ``1 world`` or ``2 worlds``, for nouns whose plural ends in s."""
    return f"{count} {noun}{'' if count == 1 else 's'}"
