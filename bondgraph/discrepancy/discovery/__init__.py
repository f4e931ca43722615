"""The whole chain: recordings and a model in, a named effect and an improved model out.

`run` is the face. `prepare` makes recordings ready, `begin` says where they begin; `search` goes round:
`propose` grows in and eases what a sketch finds worth it, `trial` fits it (`scan` and `horizon` where a fit
would not find its way), `refine` settles and simplifies the best. `bench` has what trials are made of,
`compare` and `judge` decide, `gaps` measures on held-out data, `outliers` and `constants` are what else
may be wrong. `told`, `laws`, `words`, `outside` and `apart` say it; `value` is what comes out.
"""

from .run import discover
from .value import Course, Discovery, Estimate, Explanation, Gap, LearnedLaw, NamedEffect
from .verdict import Verdict

__all__ = [
    "Course",
    "Discovery",
    "Estimate",
    "Explanation",
    "Gap",
    "LearnedLaw",
    "NamedEffect",
    "Verdict",
    "discover",
]
