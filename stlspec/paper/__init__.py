"""The experiments of Puranic, Deshmukh and Nikolaidis (CoRL 2020), run again: `python -m stlspec.paper`.

The data flows one way through the modules:
maps (random maps, shortest paths, demonstrations on them) and hills (drives of the mountain car) -> cases (the
tasks of the paper, with the figures that it prints).
"""
