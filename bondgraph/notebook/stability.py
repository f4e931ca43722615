"""View of a stability assessment: the verdict in words, then the modes."""

from __future__ import annotations

from html import escape

from ..stability import StabilityResult
from .markup import block, items
from .systems import html as system_html


def html(result: StabilityResult) -> str:
    """Return the verdict, the damping table and what limits the verdict.

    Parameters
    ----------
    result : StabilityResult

    Returns
    -------
    str
    """
    said = "".join(f"<p>{escape(line)}</p>" for line in result.verdict.splitlines())
    return block(
        f"Stability of {result.model}", said, system_html(result.system), items(result.warnings)
    )
