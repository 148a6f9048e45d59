"""The order of the numerical methods, measured on problems with an independent solution."""
