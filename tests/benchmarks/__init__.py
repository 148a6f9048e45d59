"""Speed, measured: ``python -m tests.benchmarks.master``; no test asserts a time."""
