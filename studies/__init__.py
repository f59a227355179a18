"""Studies: tables and pages that are computed once and kept in docs/."""
