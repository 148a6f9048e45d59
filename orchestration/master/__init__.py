"""A run of a system: initialization, the steps of an algorithm, rows."""
