"""Model against measured data: where they disagree, and what effect is missing.

Each stage is a function from one frozen value to the next and can be used alone. `measurement`
holds recordings, `fitting` brings parameters to them.
"""

from .measurement import Measurement

__all__ = ["Measurement"]
