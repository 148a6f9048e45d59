"""Pages about runs: self-contained HTML files with plots, tables and a diagram; no robot is known here."""
