"""One module a file format; `registry` finds the one for a file."""
