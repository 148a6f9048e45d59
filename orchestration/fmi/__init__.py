"""Access to a single FMU: its description, its library and its instances."""
