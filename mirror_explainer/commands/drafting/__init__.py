"""Drafts a user model from what a robot's own texts tell: goals, facts and words."""
