"""Names of recording formats, and the format of a file by its name and first bytes."""

from pathlib import Path

from benchnav.errors import ScenarioError, UsageError, did_you_mean
from benchnav.system.plain_file import read_file

TABLES = ("eth", "text", "trajnetpp")  # read here
PEDPY = (  # read by PedPy
    "juelich", "hdf5", "jupedsim", "vadere", "viswalk", "crowdit", "pathfinder-csv",
    "pathfinder-json",
)  # fmt: skip
FORMATS = (*TABLES, *PEDPY, "pedpy")
_SUFFIXES = {
    ".ndjson": "trajnetpp", ".h5": "hdf5", ".hdf5": "hdf5", ".sqlite": "jupedsim",
    ".traj": "vadere", ".pp": "viswalk", ".gz": "crowdit", ".json": "pathfinder-json",
}  # fmt: skip
_HEAD = 4096  # bytes that are looked at
_OBSMAT = 8  # columns


def find_format(path: Path, format: str | None) -> str:
    """Return the format of a file: ``format`` if it is given, else by suffix and first bytes.

    ``pedpy`` stands for the one of PedPy's formats that the file has.

    Raises:
        UsageError: no such format, or it must be given.
        ScenarioError: the file cannot be read.
    """
    if format is not None and format not in FORMATS:
        raise UsageError(
            f"The format must be one of {', '.join(FORMATS)}. Got {format!r} instead."
            f"{did_you_mean(format, FORMATS)}"
        )
    try:
        head = read_file(path, _HEAD)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise ScenarioError(f"{path}:1: cannot be read: {reason}.") from None
    if format not in (None, "pedpy"):
        return str(format)
    found = _format(path, head)
    if found is None or (format == "pedpy" and found not in PEDPY):
        raise UsageError(
            f"The format of {path} must be given: one of {', '.join(FORMATS[:-1])}. Neither its"
            " suffix nor its first lines name it."
        )
    return found


def _format(path: Path, head: bytes) -> str | None:
    if head.startswith(b"SQLite format 3"):
        return "jupedsim"
    if head.startswith(b"\x89HDF"):
        return "hdf5"
    if b"$VISION" in head[:64]:
        return "viswalk"
    if head.lstrip().startswith(b'{"scene"') or head.lstrip().startswith(b'{"track"'):
        return "trajnetpp"
    if path.suffix.lower() in _SUFFIXES:
        return _SUFFIXES[path.suffix.lower()]
    text = head.decode("utf-8", "replace")
    if "pedID" in text and "posX" in text:
        return "crowdit"
    if text.replace('"', "").lstrip("\ufeff").startswith("t,id,"):
        return "pathfinder-csv"
    if "framerate" in text.lower():
        return "juelich"
    if path.suffix.lower() not in (".txt", ".csv", ".dat", ".tsv"):
        return None
    rows = [line.split() for line in text.splitlines() if line.strip() and line[0] != "#"]
    return "eth" if rows and len(rows[0]) == _OBSMAT and path.suffix != ".csv" else "text"
