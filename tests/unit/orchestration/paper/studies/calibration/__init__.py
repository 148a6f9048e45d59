"""Tests of the search for a calibration."""
