"""Grounding by Fast Downward's translator: the only place that imports it (it is GPLv3)."""
