"""Stores of runs: folders in which a finished run is found again by its content, whatever ended its process."""
