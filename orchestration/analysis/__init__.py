"""Judgements on a system or a result."""
