"""Criteria: one run, or one search for a threshold, of one block or one column, by any of the methods.

What stands here decides what a run gives: `running.parts` hashes these sources, and keeps finished runs until
one of them changes.
"""
