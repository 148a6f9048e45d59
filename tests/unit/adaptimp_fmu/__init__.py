"""Parts of the exporter, one at a time."""
