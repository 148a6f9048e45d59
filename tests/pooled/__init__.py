"""FMUs that stay open over many runs: they give the bits of FMUs just loaded, and a crash costs its run."""
