"""A run at one moment, so that checks and later reads see the same content.

Nothing is copied: a pinned run holds the sha256 of every member. The manifest is read
once. A seal that differs from the pinned one is refused; the seal holds the
sha256 of the other files of its part, which are compared with the decoded bytes.
"""

import hashlib
from dataclasses import replace

from benchnav.errors import CorruptPartError
from benchnav.store.packs.pack import digest_of, members
from benchnav.store.runs.manifest import MANIFEST, parse_manifest
from benchnav.store.runs.run_folder import RunFolder
from benchnav.store.runs.scenario_files import sha256_of


def pinned(run: RunFolder) -> RunFolder:
    """Return the run in its current state; a pinned run is returned unchanged.

    Raises CorruptPartError if its manifest cannot be read any more.
    """
    if run.sums is not None:
        return run
    path = run.path / MANIFEST
    try:
        content = path.read_bytes()
        run = replace(run, manifest=parse_manifest(content.decode("utf-8"), path))
        sums = {**_sums(run), MANIFEST: hashlib.sha256(content).hexdigest()}
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise CorruptPartError(f"{path} is damaged. It cannot be read: {error}.") from error
    return replace(run, sums=sums)


def pinned_digest(run: RunFolder) -> str:
    """Return the content digest of a pinned run."""
    return digest_of(run.sums or {})


def changed_since(run: RunFolder) -> list[str]:
    """Return the names of members that changed or appeared since the run was pinned."""
    before = run.sums or {}
    try:
        now = pinned(replace(run, sums=None)).sums or {}
    except CorruptPartError:
        return [MANIFEST]
    return sorted(name for name in {*before, *now} if before.get(name) != now.get(name))


def _sums(run: RunFolder) -> dict[str, str]:
    """Return the sha256 of every member; "" if a member cannot be read."""
    sums = {}
    for name in members(run):
        try:
            sums[name] = sha256_of(run.path / name)
        except OSError:
            sums[name] = ""
    return sums
