"""Controllers from other tools for the tests: a C file, a Python class, a container; and wrong controllers."""
