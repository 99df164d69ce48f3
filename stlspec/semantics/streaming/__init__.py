"""One recording that is longer than memory: its requirements at sample 0, piece by piece.

In: samples as they come, some thousand at a time. Out: just what an evaluation of the whole recording gives, with
the deciding samples, from memory that does not grow with their number. The modules in order: pieces (the newest
samples, checked as a trace is) -> regions (which values are exact though the ends are cut off) -> views (values of a
piece, and what decides one) -> parts (what is remembered of each outermost operator) -> stream (the whole line).
"""

from stlspec.semantics.streaming.stream import Outcome, Stream, refusals

__all__ = ["Outcome", "Stream", "refusals"]
