"""Tests of the paper's scenarios from start to end: runs, figures and claims."""
