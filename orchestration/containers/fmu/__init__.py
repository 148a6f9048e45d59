"""A system as one FMU."""
