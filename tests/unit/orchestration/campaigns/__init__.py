"""Evidence for campaigns: many runs of a system."""
