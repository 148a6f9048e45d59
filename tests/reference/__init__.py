"""An independent monolithic reference of the sampled-data loop, tests of this reference, and comparisons with it."""
