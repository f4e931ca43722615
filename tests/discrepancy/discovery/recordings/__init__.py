"""Recordings of machines that lack something, by simulators that know nothing of bond graphs."""
