"""Pages in a browser: reports open from a file, without a network, and do what they say."""
