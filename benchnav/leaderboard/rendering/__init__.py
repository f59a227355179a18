"""Tables as Markdown, CSV, LaTeX, HTML and JSON."""
