"""One FMU: what it declares, its library, an instance of it."""
