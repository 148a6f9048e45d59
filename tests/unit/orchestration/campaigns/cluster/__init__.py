"""Tests of campaigns on Dask clusters."""
