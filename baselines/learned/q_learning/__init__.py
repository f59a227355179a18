"""Tabular Q-learning (Watkins & Dayan 1992): over sensor readings, and over an arena's cells."""
