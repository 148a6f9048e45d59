"""Tests of the ready studies."""
