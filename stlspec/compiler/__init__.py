"""From the syntax tree to the compiled spec: names, checks, the DAG of requirements, the DAG of formulas."""
