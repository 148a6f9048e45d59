"""Systems as WebAssembly, in node and in a browser, against the same systems in the master."""
