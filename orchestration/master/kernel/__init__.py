"""The compiled loops: numbers and addresses only."""
