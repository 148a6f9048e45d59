"""The page of the paper: what knows the arm, its claims and what may be changed."""
