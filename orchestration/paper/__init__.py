"""Lu & Meng (1991), section V: scenarios, figures and claims."""
