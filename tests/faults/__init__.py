"""Tests of errors on the command line: each prints a sentence, has the right exit code, and leaves no debris."""
