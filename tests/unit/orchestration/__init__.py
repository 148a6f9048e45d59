"""Tests of the package `orchestration` on small models with predictable numbers."""
