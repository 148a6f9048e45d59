"""The FMUs and our Jacobi master against other tools: fmpy, ecos, libcosim."""
