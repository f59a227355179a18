"""Write ``docs/paper.md``, the results of the paper, from a run of the suite ``paper``."""
