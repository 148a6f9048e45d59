"""Controllers that other people's tools make: a C file, a Python class, a container; and wrong ones."""
