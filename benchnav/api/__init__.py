"""The Python interface: thin handles on the plain records, and what the commands call.

Import the names from `benchnav` itself, which loads a module of this package when one of its
names is used.
"""
