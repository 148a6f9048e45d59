"""The master runs a system: initialization, the steps of a co-simulation algorithm, recorded rows."""
