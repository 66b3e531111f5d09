"""What was measured, in windows, and what a run would read there: channels, residual torques, impacts, sensor noise."""
