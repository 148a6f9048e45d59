"""Files that are whole or absent, temporary folders that no dead process leaves behind, and the folder of caches."""
