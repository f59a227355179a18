"""The digest of an episode: equal digests mean equal states, commands and events."""

import hashlib

import numpy as np

from benchnav.episode.episode import Episode

_DTYPES = {name: np.dtype(name) for name in ("<f8", "<i8", "|i1", "|b1")}


def digest(episode: Episode) -> str:
    """Return the sha256 over states, commands and events, as little-endian bytes in C order.

    Each array is preceded by its name, type and shape, so that no two different
    episodes share a byte stream. Timings and names do not count: they may differ. The
    kinds of commands count only if there are twists, so that digests from before
    kinds were recorded stay valid.
    """
    hashed = hashlib.sha256()
    contacts, twist = episode.contacts, episode.twist
    for name, array, dtype in (
        ("position", episode.position, "<f8"),
        ("heading", episode.heading, "<f8"),
        ("status", episode.status, "|i1"),
        ("requested", episode.requested, "<f8"),
        ("executed", episode.executed, "<f8"),
        ("body_position", episode.body_position, "<f8"),
        ("arrival", episode.arrival, "<f8"),
        ("contacts.agent", contacts.agent, "<i8"),
        ("contacts.kind", contacts.kind, "|i1"),
        ("contacts.partner", contacts.partner, "<i8"),
        ("contacts.start", contacts.start, "<f8"),
        ("contacts.end", contacts.end, "<f8"),
        ("contacts.penetration", contacts.penetration, "<f8"),
        ("contacts.closing_speed", contacts.closing_speed, "<f8"),
        ("contacts.charged", contacts.charged, "|b1"),
        *([("twist", twist, "|b1")] if twist is not None and twist.any() else []),
    ):
        fixed = np.ascontiguousarray(array, dtype=_DTYPES[dtype])
        hashed.update(f"{name} {dtype} {fixed.shape}\n".encode())
        hashed.update(fixed.data)
    return hashed.hexdigest()
