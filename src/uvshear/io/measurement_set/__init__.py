"""Measurement Sets: opened, inspected, written."""
