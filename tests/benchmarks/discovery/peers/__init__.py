"""Other packages on the same cases."""
