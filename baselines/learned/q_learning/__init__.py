"""Tabular Q-learning (Watkins & Dayan 1992): over what is sensed, and over an arena's cells."""
