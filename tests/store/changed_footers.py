"""Reads files of which one byte of the footer was changed, in a process of its own.

``python changed_footers.py CHANGE…`` prints how many of them were refused; a file must be read, or
refused by ValueError.
"""

import io
import sys

import pyarrow as pa
import pyarrow.parquet as pq

from benchnav.store.bounded import bounded_parquet

SCHEMA = pa.schema([("n", pa.int64()), ("text", pa.string()), ("list", pa.list_(pa.string()))])


def main(changes):
    out = io.BytesIO()
    pq.write_table(pa.table({"n": [1], "text": ["a"], "list": [["b"]]}, SCHEMA), out)
    content = out.getvalue()
    begin = len(content) - 8 - int.from_bytes(content[-8:-4], "little")
    refused = 0
    for at in range(begin, len(content) - 8):
        for change in changes:
            changed = bytearray(content)
            changed[at] ^= change
            try:
                bounded_parquet.read(bytes(changed), SCHEMA)
            except ValueError:
                refused += 1
    print(refused)


if __name__ == "__main__":
    main([int(change) for change in sys.argv[1:]])
