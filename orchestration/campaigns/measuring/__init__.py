"""What is kept of each run: named numbers, by formulas or functions."""
