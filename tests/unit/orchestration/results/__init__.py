"""The master, its systems, archives and results, on small units with predictable numbers."""
