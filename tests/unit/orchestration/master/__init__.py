"""Tests of the master on small components whose outputs can be predicted."""
