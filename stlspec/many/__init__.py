"""Scores of more demonstrations than one wants to hold: over processes, or over the machines of a Ray cluster.

The data flows one way through the modules:
work (one file to its scores, whatever process does it) -> engines (many files, in order, a bounded number under way)
-> journal (rows written as they come, and where to go on after an interruption) -> run (the whole line).
"""
