"""The compiled loops of the co-simulation master, which work on numbers and addresses only."""
