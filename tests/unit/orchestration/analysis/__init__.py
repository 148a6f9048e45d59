"""Tests of the energy ledger and of the stability analysis."""
