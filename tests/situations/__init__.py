"""Situations from the practice of others: files as they come, each with the right shapes or the right refusal."""
