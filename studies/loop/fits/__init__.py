"""Least squares over windows whose starting states are eliminated, and what a fit says of its parameters."""
