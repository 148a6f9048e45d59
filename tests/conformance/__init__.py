"""Every FMU against the checklist of FMI 2.0.5 rules (numbers 1 to 16 in the names of the tests)."""
