"""The paper: its figures, its claims and what they are measured with."""
