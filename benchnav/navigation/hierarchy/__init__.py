"""Planners combined with controllers: mapping, planning, replanning."""
