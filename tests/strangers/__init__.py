"""FMUs as strangers export them: each has one oddity that FMI 2.0 allows, or that harms nobody."""
