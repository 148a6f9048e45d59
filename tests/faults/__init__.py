"""What goes wrong, seen through the command line: one sentence, the right exit code, no debris."""
