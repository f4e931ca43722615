"""Model library."""
