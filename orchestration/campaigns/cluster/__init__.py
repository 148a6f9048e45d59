"""Runs of a campaign on the workers of a Dask cluster: what travels there, what must agree, and what may get lost."""
