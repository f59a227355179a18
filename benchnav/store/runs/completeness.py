"""The episodes that a run does not have yet."""

from collections.abc import Iterator, Sequence
from itertools import islice

from benchnav.store.runs.run_folder import RunFolder
from benchnav.store.runs.spans import Span, count
from benchnav.text.plural import counted

_SHOWN = 10  # cells that are named


def missing_episodes(folder: RunFolder) -> Iterator[str]:
    """Yield lines that name the missing episodes of a run; none for a complete run."""
    missing = dict(folder.missing())
    if not missing:
        return
    total = sum(count(seeds) for _, seeds in folder.planned())
    stored = total - sum(map(count, missing.values()))
    advice = f": to finish it, run the same suite with the folder {folder.path} as out."
    end = "." if folder.packed else advice
    yield f"{folder.shown} holds {stored} of {counted(total, 'episode')}{end}"
    for key, seeds in islice(missing.items(), _SHOWN):
        yield f"  missing: {_listed(seeds)} of {key}"
    if len(missing) > _SHOWN:
        yield f"  … and of {counted(len(missing) - _SHOWN, 'more cell')}"


def _listed(seeds: Sequence[Span]) -> str:
    """A few spans of seeds as text: ``seeds 0–4, 7``."""
    shown = ", ".join("–".join(map(str, sorted({a, b - 1}))) for a, b in seeds[:4])
    several = len(seeds) > 1 or seeds[0][1] - seeds[0][0] > 1
    return f"seed{'s' if several else ''} {shown}{', …' if len(seeds) > 4 else ''}"
