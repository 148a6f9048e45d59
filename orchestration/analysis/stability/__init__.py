"""Whether a co-simulation is stable at a step size, and up to which."""
