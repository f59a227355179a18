"""Run a long command with a line that says what it does and for how long.

    python .ci/step.py TEXT COMMAND [ARGUMENT…]

What the command prints is shown only where it fails: then whole, with its exit status.
"""

import shutil
import sys
from subprocess import PIPE, STDOUT, Popen
from threading import Thread
from time import monotonic

EVERY = 30.0  # [s] between lines where no terminal is


def main() -> None:
    """Run the command; exit as it does."""
    text, *command = sys.argv[1:]
    begin, lines = monotonic(), [""]
    print(f"{text} …", end="" if sys.stdout.isatty() else "\n", flush=True)
    with Popen(command, stdout=PIPE, stderr=STDOUT, text=True, errors="replace") as process:
        reader = Thread(target=lambda: [lines.append(line.strip()) for line in process.stdout])
        reader.start()
        shown = begin
        while reader.is_alive():
            reader.join(0.5)
            if monotonic() - shown > (0.5 if sys.stdout.isatty() else EVERY):
                shown = monotonic()
                now = next(line for line in reversed(lines) if not line.startswith("WARNING"))
                show(f"{text} … {shown - begin:.0f} s  {now}")
    if process.returncode:
        show(f"{text}: failed\n")
        print("\n".join(lines[1:]), file=sys.stderr)
    else:
        show(f"{text}: {monotonic() - begin:.0f} s\n")
    sys.exit(process.returncode)


def show(text: str) -> None:
    """Print a line, cut to the width of a terminal; on one it takes the place of the last."""
    width = shutil.get_terminal_size().columns - 1
    line = text.strip()[:width]
    if sys.stdout.isatty():
        end = "\n" if text.endswith("\n") else ""
        print(f"\r{line.ljust(width)}", end=end, flush=True)
    else:
        print(line, flush=True)


if __name__ == "__main__":
    main()
