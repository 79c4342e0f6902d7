"""Who listens: P(B), the beliefs that they may hold, and P_R^H, what they take the robot to be."""
