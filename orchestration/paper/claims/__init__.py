"""Measures the claims of Lu & Meng (1991) against criteria that were fixed before."""
