"""Exit codes that all commands share; 0 is success, 1 a failed run, 2 a request that cannot be carried out."""

INTERRUPTED = 130  # by Ctrl-C, as shells have it
