"""The claims of Lu & Meng (1991), measured."""
