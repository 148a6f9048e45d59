"""Names of the columns that tables and stores of every study have, besides its factors and measures."""

SYSTEM = "system"
"""Name of the variant of the system, which is a factor."""
MESSAGE, STATUS = "message", "status"
"""Why a run failed, and whether it is complete."""
RESERVED = (SYSTEM, STATUS, MESSAGE, "number", "key", "study", "run")
"""Names that no measure can have."""
