"""Packs that somebody changed, and what reading them does; a program in a process of its own.

``python hostile.py RUN N SEED`` changes a pack of RUN N times, and prints what went wrong.
"""

import contextlib
import hashlib
import io
import json
import random
import resource
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path
from zipfile import ZIP_STORED, ZipFile, ZipInfo

import pyarrow as pa
import pyarrow.parquet as pq

from benchnav.cli.main import status
from benchnav.store.packs.pack import INDEX, members
from benchnav.store.parts.part import SEAL
from benchnav.store.runs.config_key import old_form
from benchnav.store.runs.run_folder import RunFolder

SECONDS = 5.0
MEMORY = 1 << 30  # [bytes] beyond what a process holds that has read the pack once
VALUES = [
    None, True, -1, 0, 1, 3.5, 10**15, 10**18, 10**400, -(10**18), 1e308, float("inf"),
    float("nan"), "", "x",
    "x" * 300_000, "\x1b[31m", "\ud800", "=1+1", "../../x", [], [[]], [None], ["a", "b"],
    {}, {"a": 1}, [0, 10**12], [["x"] * 3] * 1000, {str(i): i for i in range(1000)},
]  # fmt: skip
TYPES = [pa.string(), pa.int64(), pa.float64(), pa.bool_(), pa.large_string(), pa.binary(),
         pa.list_(pa.string()), pa.int8(), pa.timestamp("ns"), pa.null()]  # fmt: skip
Files = dict[str, bytes]


def digest(content):
    return {"bytes": len(content), "sha256": hashlib.sha256(content).hexdigest()}


def checked(fields):
    """A manifest or seal, with the digest that fits."""
    fields = {k: v for k, v in fields.items() if k != "sha256"} if isinstance(fields, dict) else {}
    with contextlib.suppress(KeyError, TypeError):
        suite = json.dumps(old_form(fields["suite"]), sort_keys=True, separators=(",", ":"))
        fields["suite_hash"] = hashlib.sha256(suite.encode()).hexdigest()
    text = json.dumps(fields, sort_keys=True, separators=(",", ":"))
    return json.dumps({**fields, "sha256": hashlib.sha256(text.encode()).hexdigest()}).encode()


def resealed(files: Files) -> Files:
    """The files, with seals that fit those of their part."""
    sealed = dict(files)
    for name in files:
        if name.endswith(SEAL):
            stem = name.removesuffix(SEAL)
            first, stop = map(int, stem.rpartition("/")[2].split("-"))
            said = {n.removeprefix(stem): digest(c) for n, c in files.items()
                    if n.startswith(stem) and n != name}  # fmt: skip
            sealed[name] = checked({**said, "episodes": stop - first})
    return sealed


def packed(files: Files, index=None) -> bytes:
    """A pack of the files, whose index fits."""
    index = index or {"format": 1, "files": {n: digest(c) for n, c in files.items()}}
    out = io.BytesIO()
    with ZipFile(out, "w", ZIP_STORED) as archive:
        for name, content in {INDEX: json.dumps(index).encode(), **files}.items():
            info = ZipInfo(name, (1980, 1, 1, 0, 0, 0))
            info.external_attr = 0o100644 << 16
            archive.writestr(info, content)
    return out.getvalue()


def places(value, path=()):
    """The path of every value within a JSON value."""
    yield path
    listed = enumerate(value) if isinstance(value, list) else ()
    for key, item in value.items() if isinstance(value, dict) else listed:
        yield from places(item, (*path, key))


def with_value(rng, fields):
    """A JSON value of which one is dropped, renamed or replaced by a hostile one."""
    path = rng.choice([p for p in places(fields) if p])
    holder = fields
    for key in path[:-1]:
        holder = holder[key]
    what = rng.randrange(6)
    if what == 0:
        del holder[path[-1]]
    elif what == 1 and isinstance(holder, dict):
        holder[f"{path[-1]}x"] = holder[path[-1]]
    else:
        holder[path[-1]] = rng.choice(VALUES)
    return fields


def flipped(rng, content, most=6):
    changed = bytearray(content)
    for _ in range(rng.randint(1, most)):
        changed[rng.randrange(len(changed))] ^= 1 << rng.randrange(8)
    return bytes(changed)


def cut(rng, content):
    at, end = sorted(rng.sample(range(len(content)), 2))
    return rng.choice([content[:at], content[:at] + content[end:], content[:end] + content[at:]])


def any_bytes(rng, files):
    """Bytes of the whole pack, of which nothing is made to fit."""
    return rng.choice([flipped, cut])(rng, packed(files))


def of_a_file(rng, files):
    """Bytes of one file, which is sealed again: the decoder meets them."""
    name = rng.choice([n for n in files if n.endswith(".parquet")])
    content = files[name]
    if rng.random() < 0.5:  # the footer, where the sizes stand
        length = int.from_bytes(content[-8:-4], "little") + 8
        changed = content[:-length] + flipped(rng, content[-length:], 3)
    else:
        changed = rng.choice([flipped, cut])(rng, content)
    return packed(resealed({**files, name: changed}))


def swapped(rng, files):
    one, other = rng.sample(sorted(files), 2)
    changed = {**files, one: files[other], other: files[one]}
    return packed(rng.choice([resealed(changed), changed]))


def of_json(rng, files):
    """A value of the manifest or a seal; their digests fit again."""
    name = rng.choice(["manifest.json"] * 3 + [n for n in files if n.endswith(SEAL)])
    return packed({**files, name: checked(with_value(rng, json.loads(files[name])))})


def of_index(rng, files):
    index = {"format": 1, "files": {n: digest(c) for n, c in files.items()}}
    return packed(files, with_value(rng, index))


def of_text(rng, files):
    """JSON that is none, or is a burden."""
    name = rng.choice(["manifest.json", *[n for n in files if n.endswith(SEAL)]])
    text = files[name]
    content = rng.choice([
        b"[" * 200_000, b'{"a":' * 100_000, b" " * 30_000_000, b"\xef\xbb\xbf" + text, b"", b"null",
        text.replace(b"{", b'{"sha256": 1,', 1), b"[" + b"[]," * 3_000_000 + b"[]]", text + b"}",
        text.replace(b'"', b'"\xff', 1), b"1" * 5000,
        text.replace(b":", b":" + b" " * 70_000_000, 1),
    ])  # fmt: skip
    return packed({**files, name: content})


def of_column(rng, files):
    """A column that is retyped, replaced, dropped, doubled, or stored in another way."""
    name = rng.choice([n for n in files if n.endswith(".parquet")])
    table = pq.read_table(io.BytesIO(files[name]))
    column = rng.choice(table.column_names)
    at = table.column_names.index(column)
    kind = table.schema.field(column).type
    what = rng.randrange(6)
    with contextlib.suppress(pa.ArrowException, ValueError, TypeError, OverflowError):
        if what == 0:
            table = table.drop_columns([column])
        elif what == 1:
            table = table.append_column(rng.choice([column, "new"]), table[column])
        elif what == 2:
            table = table.set_column(at, column, pa.nulls(len(table), rng.choice([kind, *TYPES])))
        elif what == 3:
            table = table.slice(0, rng.randrange(len(table)))
        elif what == 4:
            table = pa.concat_tables([table] * rng.choice([2, 50, 2000 if len(table) > 9 else 100]))
        else:
            value = rng.choice([*VALUES, b"\xff", 2**63 - 1, -0.0, ["\x1b[2J"] * 3, [float("inf")]])
            array = pa.array([value] * len(table), rng.choice([kind, kind, None]))
            table = table.set_column(at, column, array)
    return packed(resealed({**files, name: stored(rng, table)}))


def stored(rng, table):
    out = io.BytesIO()
    encoding = rng.choice([None, None, None, "DELTA_BYTE_ARRAY", "DELTA_BINARY_PACKED"])
    options = {
        "compression": rng.choice(["zstd", "zstd", "snappy", "gzip", "none"]),
        "row_group_size": rng.choice([1 + len(table) // 40, 1 << 20]),
        "store_schema": rng.random() < 0.9,
        "data_page_version": rng.choice(["1.0", "2.0"]), "use_dictionary": rng.random() < 0.7,
    }  # fmt: skip
    texts = [f.name for f in table.schema if pa.types.is_string(f.type)]
    if encoding == "DELTA_BYTE_ARRAY" and texts:
        options |= {"use_dictionary": False, "column_encoding": dict.fromkeys(texts, encoding)}
    with contextlib.suppress(pa.ArrowException, ValueError, TypeError):
        pq.write_table(table, out, **options)
        return out.getvalue()
    out = io.BytesIO()
    pq.write_table(table.select(table.column_names[:1]), out)
    return out.getvalue()


def bomb(rng, files):
    """A small file that decodes to gigabytes."""
    name = rng.choice([n for n in files if n.endswith(".parquet")])
    table = pq.read_table(io.BytesIO(files[name]))
    rows = rng.choice([20_000, 1_000_000])
    many = table.slice(0, 1).take(pa.array([0] * rows)) if "world" not in table.column_names else (
        table.slice(0, 1).drop_columns(["world"]).take(pa.array([0] * (rows // 500))))  # fmt: skip
    texts = [f.name for f in table.schema if pa.types.is_string(f.type)]
    column = rng.choice(texts)
    if rows == 20_000:
        long = pa.DictionaryArray.from_arrays(
            pa.array([0] * len(many), pa.int32()), pa.array(["x" * (1 << 20)])
        )
        at = many.column_names.index(column)
        many = many.set_column(at, pa.field(column, long.type), long)
    out = io.BytesIO()
    pq.write_table(many, out, compression="zstd", dictionary_pagesize_limit=1 << 30,
                   store_schema=False, row_group_size=rng.choice([1 << 12, 1 << 24]))  # fmt: skip
    return packed(resealed({**files, name: out.getvalue()}))


CHANGES = [any_bytes, of_a_file, of_a_file, swapped, of_json, of_json, of_index, of_text,
           of_column, of_column, bomb]  # fmt: skip
VERBS = [("leaderboard", "--format", "csv"), ("leaderboard", "--recompute", "--metric", "success"),
         ("verify", "--workers", "0", "--twin", "0"),
         ("leaderboard", "--curve", "horizon")]  # fmt: skip


def told(arguments):
    """(status, stdout, stderr) of a command."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        code = status(arguments)
    return code, out.getvalue(), err.getvalue()


def wrong(path, verb, fits):
    """What is not as it must be when a changed pack is read; "" if all is.

    ``fits``: the table it gives must be this, or it must be refused.
    """
    began = time.process_time()  # other work on the machine does not count
    try:
        code, out, err = told([verb[0], str(path), *verb[1:]])
    except BaseException as error:
        return f"{type(error).__name__}: {str(error)[:300]}"
    seconds = time.process_time() - began
    if seconds > SECONDS:
        return f"took {seconds:.1f} s"
    if any(c in out + err for c in "\x1b\x07\x9b\u202e"):
        return f"prints what controls a terminal: {out + err!r}"[:300]
    complaints = [line for line in err.splitlines() if line.startswith("benchnav: ")]
    if code and verb[0] != "verify" and (out or len(complaints) != 1 or len(err) > 3000):
        return f"is not refused in one sentence: {code} {err!r}"[:300]
    if not code and fits and verb == VERBS[0] and out != fits:
        return "gives another table"
    return ""


def main(run, times, seed):
    folder = RunFolder.open(run)
    files = {name: (Path(run) / name).read_bytes() for name in sorted(members(folder))}
    with tempfile.TemporaryDirectory() as scratch:
        pack = Path(scratch) / "x.bnrun"
        pack.write_bytes(packed(files))
        reference = [told([verb[0], str(pack), *verb[1:]]) for verb in VERBS]
        assert not any(code for code, _, _ in reference), reference
        found, counts = [], Counter()
        for k in range(seed, seed + times):
            rng = random.Random(k)
            change, verb = CHANGES[k % len(CHANGES)], VERBS[rng.choice([0, 0, 1, 2, 2, 3])]
            pack.write_bytes(change(rng, files))
            pa.default_memory_pool().release_unused()
            held = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
            resource.setrlimit(resource.RLIMIT_AS, (held + MEMORY, resource.RLIM_INFINITY))
            complaint = wrong(pack, verb, reference[0][1] if change is any_bytes else "")
            resource.setrlimit(resource.RLIMIT_AS, (resource.RLIM_INFINITY,) * 2)
            counts[change.__name__] += 1
            if complaint:
                found.append(f"{k} {change.__name__} {' '.join(verb)}: {complaint}")
                print(found[-1], flush=True)
    print(f"{counts.total()} packs, {len(found)} wrong: {dict(counts)}")
    return len(found) > 0


if __name__ == "__main__":
    raise SystemExit(main(Path(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3])))
