"""Reads zip archives of strangers by one strict reader, so that no second reader can see another archive in them."""
