"""A system as a folder of C."""
