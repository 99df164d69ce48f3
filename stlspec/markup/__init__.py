"""HTML and SVG as text, for reports and notebooks: elements -> figures, charts, graphs, grids, tables."""
