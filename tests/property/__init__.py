"""Tests of identities that hold at every state: of mechanics, of the control laws, of the wall and the trajectories."""
