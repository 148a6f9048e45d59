"""Tests of the safety checks of archives."""
