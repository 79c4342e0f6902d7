"""Actions that take time, as actions that happen at once."""
