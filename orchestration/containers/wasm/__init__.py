"""A system as a module of WebAssembly."""
