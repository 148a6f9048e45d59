"""An independent monolithic reference of the sampled-data loop, and its own checks."""
