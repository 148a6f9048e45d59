"""Tests of the access to a single FMU: description, library and instance."""
