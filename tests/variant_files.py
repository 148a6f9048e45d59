"""The files of variants of the catalog, and of its models, each found once in a process."""

from functools import cache

from orchestration.paper.built_fmus import built

file_of = cache(built)
"""The FMU file of an identifier, from the cache or built; to find it takes up to a second, declaring its model."""
