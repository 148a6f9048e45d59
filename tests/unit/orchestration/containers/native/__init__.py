"""Native libraries of systems."""
