"""A navigator that knows the frames and nothing of benchnav: stands still, or misbehaves.

Run as ``python stranger.py HOW``; it is what an author in another language would write.
"""

import json
import math
import os
import struct
import sys
import time

HEAD, FIELD = struct.Struct("<8sQQ"), struct.Struct("<24scB6x4Q")


def read():
    head = sys.stdin.buffer.read(HEAD.size)
    if not head:
        sys.exit(0)
    kind, count, size = HEAD.unpack(head)
    body, at, fields = sys.stdin.buffer.read(size), 0, {}
    for _ in range(count):
        name, code, axes, *shape = FIELD.unpack_from(body, at)
        items = math.prod(shape[:axes])
        size = items * (8 if code in b"dq" else 1)
        data = body[at + FIELD.size : at + FIELD.size + size]
        fields[name.rstrip(b"\0").decode()] = shape[:axes], data
        at += FIELD.size + size + -size % 8
    return kind.rstrip(b"\0").decode(), fields


def write(kind, name="", code=b"t", shape=(), data=b"", flush=True):
    body = b""
    if name:
        shape = (*shape, 0, 0, 0, 0)[:4], len(shape)
        body = FIELD.pack(name.encode(), code, shape[1], *shape[0]) + data + bytes(-len(data) % 8)
    sys.stdout.buffer.write(HEAD.pack(kind.encode(), 1 if name else 0, len(body)) + body)
    if flush:
        sys.stdout.buffer.flush()


def send_text(kind, text):
    write(kind, "text", shape=(len(text.encode()),), data=text.encode())


def command(fields, how, flush=True):
    worlds, agents = fields["active"][0]
    value = math.nan if how == "nan" else 0.25
    shape = (worlds, agents, 3 if how == "shape" else 2)
    if how == "flags":
        return write("command", "command", b"?", shape, bytes(math.prod(shape)))
    data = struct.pack("<d", value) * math.prod(shape)
    return write("command", "command", b"d", shape, data, flush)


def main(how):
    acts = 0
    while True:
        kind, fields = read()
        if kind == "hello":
            if how == "echo":
                print(json.loads(fields["text"][1])["config"], file=sys.stderr)
            if how == "dies at once":
                sys.exit("no licence")
            answer = {"needs": ["sonar"]} if how == "strange" else {"remarks": how == "remarks"}
            send_text("ready", json.dumps(answer))
        elif kind == "reset":
            if how == "dies in reset":
                os.abort()
            write("done")
        elif kind == "remarks":
            send_text("remarks", json.dumps(["I was here"]))
        else:
            acts += 1
            if acts == 3 and how == "exits":
                sys.exit("out of fuel")
            if acts == 3 and how == "hangs":
                time.sleep(60)
            if acts == 3 and how == "prints":
                print("a line of talk on the wrong pipe", flush=True)
            if acts == 3 and how == "refuses":
                write("failed", "reason", shape=(4,), data=b"lost")
            elif acts == 3 and how == "other":
                write("done")
            elif acts == 3 and how == "late":
                command(fields, how)
                time.sleep(0.2)  # the runner's next request waits in the pipe
                command(fields, how)
            elif acts == 3 and how == "twice":
                command(fields, how, flush=False)
                command(fields, how)
            else:
                command(fields, how)


if __name__ == "__main__":
    main(sys.argv[1])
