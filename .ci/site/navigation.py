"""Expands patterns in the navigation of the site to the pages that they stand for."""

from collections.abc import Iterator, Sequence
from fnmatch import fnmatchcase
from typing import Any


def expanded(nav: Sequence[Any], pages: Sequence[str]) -> list[Any]:
    """The navigation with pages in the place of patterns.

    Parameters
    ----------
    nav
        Entries as in the configuration of MkDocs: a path, or a mapping from a title to a path or to further entries.
    pages
        Paths of all pages. A pattern stands for those that match, in the order of their names, but not for those that
        an entry names itself.

    Returns
    -------
    list
        The same entries, without those of patterns that no page matches.
    """
    named = set(_paths(nav))
    return _expanded(nav, [page for page in sorted(pages) if page not in named])


def _paths(nav: Any) -> Iterator[str]:
    """Paths of all entries, patterns included."""
    if isinstance(nav, str):
        yield nav
    elif isinstance(nav, dict):
        for below in nav.values():
            yield from _paths(below)
    else:
        for entry in nav:
            yield from _paths(entry)


def _expanded(nav: Sequence[Any], free: Sequence[str]) -> list[Any]:
    """Entries of one level."""
    found: list[Any] = []
    for entry in nav:
        if isinstance(entry, str) and "*" in entry:
            found += [page for page in free if _matches(page, entry)]
        elif isinstance(entry, dict):
            found += [{k: _expanded(v, free) if isinstance(v, list) else v} for k, v in entry.items()]
        else:
            found.append(entry)
    return found


def _matches(page: str, pattern: str) -> bool:
    """Whether a pattern matches; ``*`` stands for no slash."""
    return fnmatchcase(page, pattern) and page.count("/") == pattern.count("/")
