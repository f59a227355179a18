"""What the paper shows, measured: ``docs/paper.md`` from a run of the suite ``paper``."""
