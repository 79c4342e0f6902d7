"""The general way to plan: any engine of unified-planning, one call a belief."""
