"""Shows that a figure's run has the same bits on every processor, system and in every form that runs on this machine.

``python -m tests.conformance.platforms.same_bits`` prints one hash of all rows for each figure and program.
"""
