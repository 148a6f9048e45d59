"""Ready studies of the paper's systems, and what is read from their tables."""
