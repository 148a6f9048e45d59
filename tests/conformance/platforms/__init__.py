"""One FMU on five platforms: built, read, and run where something runs it."""
