"""Description of a coupled system: components, their start values and their connections."""
