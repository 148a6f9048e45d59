"""Tests of the package `adaptimp_files`, one module at a time."""
