"""The runtime under sanitizers, a fuzzer and valgrind; how much of it the tests execute."""
