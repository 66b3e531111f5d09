"""What whole records tell, for which swings are too short: fits, rivals, scans, floors, and both brought together."""
