"""The fast way to plan: Fast Downward, with all beliefs of a task grounded at once."""
