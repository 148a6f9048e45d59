"""Systems as one program."""
