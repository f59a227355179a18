"""A forger: changes what a run says, and makes all checksums fit again."""

import dataclasses
import hashlib
import json
import re
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from benchnav.store.parts.digest import digest
from benchnav.store.parts.episodes import from_table, to_table
from benchnav.store.parts.part import EPISODES_FILE, FILES, SEAL
from benchnav.store.runs import checked_json
from benchnav.store.runs.manifest import Manifest


class Forger:
    def __init__(self, run):
        self.run = run

    def stems(self, cell=""):
        """What the names of the files of the parts start with, of cells whose key has ``cell``."""
        return sorted(
            str(seal)[: -len(SEAL)]
            for seal in self.run.glob(f"parts/*/*{SEAL}")
            if cell in seal.parent.name
        )

    def seal(self, stem):
        """Let the seal of a part be that of its files."""
        said = json.loads(Path(stem + SEAL).read_text())
        del said["sha256"]
        for suffix in FILES:
            if suffix in said:
                content = Path(stem + suffix).read_bytes()
                said[suffix] = {
                    "bytes": len(content), "sha256": hashlib.sha256(content).hexdigest(),
                }  # fmt: skip
        Path(stem + SEAL).write_text(checked_json.dump(said))

    def column(self, stem, suffix, name, change, row=0):
        """Change one value of a column."""
        table = pq.read_table(stem + suffix)
        values = table[name].to_pylist()
        before = values[row]
        values[row] = change(before)
        assert values[row] != before or values[row] != values[row], name
        at = table.column_names.index(name)
        table = table.set_column(at, name, pa.array(values, table.schema.field(name).type))
        pq.write_table(table, stem + suffix)
        self.seal(stem)

    def episode(self, stem, change, suffix=EPISODES_FILE, row=0):
        """Change an episode, and give it the digest that fits."""
        episodes = list(from_table(pq.read_table(stem + suffix)))
        changed = change(episodes[row])
        episodes[row] = dataclasses.replace(changed, digest=digest(changed))
        pq.write_table(to_table(episodes), stem + suffix)
        self.seal(stem)

    def manifest(self, change):
        """Change the manifest, and give it the hashes that fit."""
        path = self.run / "manifest.json"
        said = json.loads(path.read_text())
        change(said)
        names = {field.name for field in dataclasses.fields(Manifest)}
        path.write_text(Manifest(**{k: v for k, v in said.items() if k in names}).dump())


def flipped(value):
    """Another value of the same type, as near as can be."""
    if isinstance(value, bool):
        return not value
    if isinstance(value, float):
        return 0.5 if value != value else float(np.nextafter(value, np.inf))
    if isinstance(value, int):
        return value + 1
    if isinstance(value, str):
        return value + "x"
    if isinstance(value, list):
        middle = len(value) // 2
        return [*value[:middle], flipped(value[middle]), *value[middle + 1 :]] if value else ["x"]
    if value is None:
        return "x"
    raise AssertionError(value)


def numbers_of(text):
    """Where the numbers of a JSON text stand: (first, last) of each."""
    return [found.span() for found in re.finditer(r"(?<=[\[,:])-?\d+(?:\.\d+)?(?:e-?\d+)?", text)]
