"""Campaigns of which only outcomes were noted: who fell, and who did not; `closing.close` is where it begins."""
