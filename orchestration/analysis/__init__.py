"""Analyses that judge a coupled system before a run, or the result after a run."""
