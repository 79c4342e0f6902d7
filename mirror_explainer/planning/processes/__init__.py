"""Processes that plan: started, confined, talked to, and ended."""
