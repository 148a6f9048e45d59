"""Robot arms: kinematics, dynamics, and regressors of the dynamics."""
