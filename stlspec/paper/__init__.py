"""The experiments of Puranic, Deshmukh and Nikolaidis (CoRL 2020), run again: `python -m stlspec.paper`.

The data flows one way through the modules:
maps (random maps, shortest paths, demonstrations on them) and hills (drives of the mountain car) -> cases (the
tasks of the paper, with the figures that it prints) -> runs (many runs of the learner as rows of figures) and
inference (Algorithm 1 measured), within budgets -> experiments -> journal (what was measured, as files) -> claims
(what reproduces, by rule), tables (with spread: quartiles) and figures -> report -> command.
Baselines: handmade (Q-learning on hand-crafted rewards, as runs has it for ours); a case -> tabular (as the tables
of a Markov decision process) -> irl (MCE-IRL, in an environment of its own that libraries makes, run there by the
script mce_irl).
"""
