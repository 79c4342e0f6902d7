"""Numbers of a task: what never changes is worked out, costs become sums of what actions cost."""
