"""Tests of reading and writing SSP packages."""
