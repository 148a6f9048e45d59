"""A system as one program, which needs no master: a folder of C, an FMU, or WebAssembly."""
