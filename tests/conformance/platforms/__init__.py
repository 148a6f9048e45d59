"""Tests of an FMU for five platforms: it is built, read, and run where this machine can run it."""
