"""The C program of a system against the master."""
