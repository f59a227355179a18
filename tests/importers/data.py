"""Where the published files lie."""

import os
from pathlib import Path

import pytest

DATA = Path(os.environ.get("BENCHNAV_DATA", Path(__file__).parents[3] / "shared" / "data"))


def published(name):
    path = DATA / name
    if not path.exists():
        pytest.skip(f"no published files in {DATA}: set BENCHNAV_DATA")
    return path
