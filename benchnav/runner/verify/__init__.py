"""Checks what a run says, without the navigators that it was made with.

A run stores commands. Everything else in it follows from these, the scenarios and the
seeds: worlds are drawn again, commands re-simulated, values measured again, and every
stored number that does not agree is a finding.
"""
