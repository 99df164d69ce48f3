"""Tools around the compiler, each a client of the public API."""
