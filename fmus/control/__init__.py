"""Laws of control and adaptation, and what controllers have in common."""
