"""Races against named baselines, measured in the same run.

``python -m tests.benchmarks`` runs them all, ``python -m tests.benchmarks brake`` one of them. A
figure from here means something only beside its baseline, so every table carries the ratio.
"""

from __future__ import annotations
