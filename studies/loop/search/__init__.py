"""The way from the calibrated block to what explains the campaign: round by round, back where needed, without names."""
