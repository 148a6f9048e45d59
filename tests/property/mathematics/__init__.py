"""Tests of the runtime's mathematics (adaptimp_fmu/runtime/mathematics.h) against mpmath."""
