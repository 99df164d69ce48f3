"""The formatter: one canonical text for a syntax tree, with its comments and blank lines in their order."""
