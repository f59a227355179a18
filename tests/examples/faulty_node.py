"""A node that does something wrong: ``python faulty_node.py SOCKET FAULT``."""

import os
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2] / "examples" / "ros2_controller"))

from channel import serve

FAULT = sys.argv[2]
TWIST = {"linear": {"x": 0.5, "y": 0.0}, "angular": {"z": 0.0}}
FAULTY = {
    "nan": {"linear": {"x": float("nan")}, "angular": {"z": 0.0}},
    "sideways": {"linear": {"x": 0.1, "y": 0.2}, "angular": {"z": 0.0}},
    "other type": {"data": "forward"},
}


def drive(channel):
    channel.send({"start": "soon"} if FAULT == "greeting" else {"start": 100.0})
    for decision in range(10**6):  # the first request is that of `reset`
        topics = channel.receive()["await"]
        wrong = decision >= 3
        if wrong and FAULT == "silent":
            time.sleep(60)
        if wrong and FAULT == "dies":
            os._exit(1)
        if wrong and FAULT == "closes":
            return
        if wrong and FAULT == "garbage":
            channel._file.write(b"cmd_vel = 1\n")
            channel._file.flush()
            continue
        if wrong and FAULT == "mute":
            channel.send({"received": {}})
            continue
        twist = FAULTY.get(FAULT, TWIST) if wrong else TWIST
        channel.send({"received": {topic: {"twist": twist} for topic in topics}})


serve(sys.argv[1], drive)
