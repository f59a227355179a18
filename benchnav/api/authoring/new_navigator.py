"""Write a template of a navigator package."""

import re
from os import PathLike
from pathlib import Path

from benchnav.api.authoring.free_name import free_name, name_taken
from benchnav.api.authoring.navigator_template import navigator_package
from benchnav.errors import UsageError
from benchnav.processes.main_module import stop_import_of_main
from benchnav.system.plain_file import writing


def new_navigator(name: str, folder: "str | PathLike[str] | None" = None) -> Path:
    """Write a complete navigator package, and return its folder.

    It has a module, an entry point, a test and a README, and can be installed and run as it is.

    Args:
        name: of the navigator and the package: small letters, digits and single hyphens.
        folder: missing or empty; None: the name, in the working directory.

    Raises UsageError for a name or folder that is not possible, and StoreError where the folder
    cannot be written.
    """
    stop_import_of_main()
    if not re.fullmatch(r"[a-z][a-z0-9]*(-[a-z0-9]+)*", name):
        raise UsageError(
            "The name must be small letters, digits and single hyphens, a letter first."
            f" Got {name!r} instead."
        )
    if taken := name_taken(name):
        raise UsageError(f"The name must be free. {taken}. {free_name(name)!r} is free.")
    target = Path(name if folder is None else folder)
    if target.exists() and (not target.is_dir() or any(target.iterdir())):
        raise UsageError(f"{target} must be missing or an empty folder. It is not empty.")
    for file, text in navigator_package(name).items():
        with writing(target / file):
            (target / file).parent.mkdir(parents=True, exist_ok=True)
            (target / file).write_text(text, encoding="utf-8")
    return target
