"""Campaigns: many runs of a system with varied start values, each of them a row of a table."""
