"""Tests of one module at a time, without other tools and without long runs."""
