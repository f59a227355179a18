"""Counts with a noun in singular or plural, and lists of names in a sentence."""

from collections.abc import Sequence


def counted(count: int, noun: str) -> str:
    """Return ``1 world`` or ``2 worlds``, for nouns with a plural in s."""
    return f"{count} {noun}{'' if count == 1 else 's'}"


def listed(names: Sequence[str]) -> str:
    """Return ``a``, ``a and b`` or ``a, b and c``."""
    *first, last = names
    return f"{', '.join(first)} and {last}" if first else last
