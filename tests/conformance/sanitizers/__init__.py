"""Tests of the C runtime under sanitizers, a fuzzer and valgrind, and the coverage of the tests."""
