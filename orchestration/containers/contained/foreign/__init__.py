"""FMUs of other tools as parts of a program, called by FMI's functions."""
