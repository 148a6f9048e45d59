"""The units of `fmus` as they are declared: starts, sensor, actuator."""
