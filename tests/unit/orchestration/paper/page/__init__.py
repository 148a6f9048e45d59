"""Tests of pages about runs."""
