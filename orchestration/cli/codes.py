"""Exit codes of the commands of ``adaptimp``: 0 success, 1 a failed run, 2 a request that cannot be carried out."""

INTERRUPTED = 130  # by Ctrl-C, as shells have it
