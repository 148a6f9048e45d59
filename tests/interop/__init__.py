"""The FMUs and our master against other tools, fmpy, ecos, libcosim, and with controllers that others make."""
