"""Evidence that the wheel works where only the core is installed."""
