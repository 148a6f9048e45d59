"""Tests of the models in `fmus` as they are declared: start values, sensor, actuator."""
