"""Recorded results of a run, in memory and in CSV and Parquet files."""
