"""stlspec: a declarative language and compiler toolkit for Signal Temporal Logic."""
