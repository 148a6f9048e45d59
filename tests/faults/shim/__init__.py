"""An FMU of the project's own exporter that misbehaves on demand, and what is documented to come of that."""
