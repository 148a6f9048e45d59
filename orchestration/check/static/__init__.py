"""Rules about the files in an FMU, which nothing of it is run for."""
