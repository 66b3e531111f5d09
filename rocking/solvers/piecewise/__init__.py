"""What the solvers share that carry Method 1 from interval to interval of its base: `exact` and `taylor`.

`motion` says of which base motions they know the form, `polynomial` finds where one comes down through zero, `run_log`
is where a run is written down.
"""
