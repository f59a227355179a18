"""``python -m studies.paper RUN [--out docs]``: the page about the paper, from a run of it.

RUN is a folder that ``benchnav run paper --out RUN`` left. Writes ``paper.md``, and its
pictures into ``images/``.
"""

import argparse
from pathlib import Path

from .page import page
from .pictures import Pictures


def main() -> None:
    """Read the run, write the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("run", type=Path)
    parser.add_argument("--out", type=Path, default=Path("docs"))
    options = parser.parse_args()
    text = page(options.run, Pictures(options.out / "images"))
    (options.out / "paper.md").write_text(text, encoding="utf-8")
    print(options.out / "paper.md")


if __name__ == "__main__":
    main()
