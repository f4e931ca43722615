"""Settings of all tests: random examples are the same in every run, unless asked to explore.

``HYPOTHESIS_PROFILE=explore make pytest`` draws new ones each time.
"""

import os

from hypothesis import settings

settings.register_profile("reproducible", derandomize=True)
settings.register_profile("explore")
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "reproducible"))
