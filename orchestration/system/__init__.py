"""What is coupled: components, their start values and connections."""
