"""FMUs in processes of their own: the same numbers, and nothing that an FMU does reaches the run."""
