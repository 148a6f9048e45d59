"""Laws of impedance control and of parameter adaptation, and what the controllers share."""
