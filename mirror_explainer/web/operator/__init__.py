"""The operator's page: one button, "What are you up to?", and what the answer does."""
