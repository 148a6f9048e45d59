"""What pages show of the paper's arm: the arm in motion, its four panels, claims and assumed values."""
