"""Recording demonstrations in a browser: world, drawing of frames -> session -> desk -> server -> recording."""
