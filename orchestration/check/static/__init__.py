"""Rules about the files in an FMU, which are checked without running the FMU."""
