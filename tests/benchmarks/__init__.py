"""Programs that measure the speed of runs, such as ``python -m tests.benchmarks.master``; no test asserts a time."""
