"""What several figures of the paper share: the plan, the dataset and the drawing of a family of figures.

`onset` is Figs 14 and 15; `columns` Figs 18, 19 and 23; `records` Figs 2 and 3; `numerical_stability` Figs 10 to 12.
"""
