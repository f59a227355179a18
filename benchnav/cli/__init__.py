"""The command `benchnav`, with one file per verb."""
