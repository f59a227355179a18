"""The record of one run of one navigator in one world."""
