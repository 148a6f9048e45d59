"""A system as one program, which needs no master: C, from which an FMU and WebAssembly are made."""
