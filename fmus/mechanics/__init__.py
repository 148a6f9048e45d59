"""Arms: kinematics, dynamics and regressors."""
