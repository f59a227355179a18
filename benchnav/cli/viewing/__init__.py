"""Commands that show installed components."""
