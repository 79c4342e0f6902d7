"""What planning for many beliefs costs, and what more plans of each bring."""
