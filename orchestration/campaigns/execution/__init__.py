"""How the runs of a study are made: in chunks, by threads, with a count of what is done."""
