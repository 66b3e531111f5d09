"""What single swings tell: one effect, or one learned coefficient, tried on top of another model."""
