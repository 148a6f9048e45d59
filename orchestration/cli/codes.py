"""Exit codes that are no matter of one command: 0 success, 1 a run failed, 2 the request cannot be carried out."""

INTERRUPTED = 130  # by Ctrl-C, as shells have it
