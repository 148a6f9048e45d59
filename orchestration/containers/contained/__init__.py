"""How FMUs become parts of a program."""
