"""The gate that every archive of a stranger passes, and the processes that strangers' binaries run in."""
