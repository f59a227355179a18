"""Learned navigators."""
