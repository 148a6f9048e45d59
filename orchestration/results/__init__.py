"""What a run recorded, in memory and in files."""
