"""The paper's checkable statements: what decides each, written down beforehand, and the table of what became of them.

`python -m studies.claims` prints them all.
"""
