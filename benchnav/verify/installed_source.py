"""Compare the installed code of a navigator with the code that produced a run's episodes."""

from benchnav.runner.plan.contestant import Contestant, source_of
from benchnav.source.importable import MAIN
from benchnav.source.module import locate
from benchnav.verify.untrusted_spec import is_by_module, is_program


def compare_source(contestant: Contestant, packed: bool) -> str:
    """Return a sentence about the navigator ``entry`` of a run, without importing it.

    ``packed``: the run came in a pack. Modules that an untrusted pack names are not searched.
    """
    label = contestant.label
    if not contestant.source_hash:
        return f"{label}: not recorded, so it cannot be compared with the installed source"
    if packed and (is_program(contestant.spec) or is_by_module(contestant.spec)):
        return f"{label}: not compared, because an untrusted pack names it by file or module"
    modules = [place.partition(":")[0] for place in contestant.places]
    if MAIN in modules:
        return f"{label}: a notebook or script defined it, which cannot be compared"
    missing = sorted({module for module in modules if locate(module) is None})
    if missing:
        return f"{label}: not installed here (no module {', '.join(missing)})"
    found = source_of(contestant).hash
    if found == contestant.source_hash:
        return f"{label}: the source that ran is installed here ({found})"
    return f"{label}: another source is installed here ({found}; {contestant.source_hash} ran)"
