"""An independent monolithic reference of the loop of an arm in space: Pinocchio's dynamics and laws of its own."""
