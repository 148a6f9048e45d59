"""A system as a native library in this process, which makes many runs in one call."""
