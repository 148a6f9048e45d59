"""Tests of results in memory and in files."""
