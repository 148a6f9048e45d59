"""Tests of programs that contain FMUs of other tools, made of the sources that these FMUs bring."""
