"""Tests of the FMUs and the master against other tools (fmpy, ecos, libcosim), and with controllers of other tools."""
