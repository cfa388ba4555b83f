"""Commands that are killed at any moment: what they leave, and what the next run makes of it."""
