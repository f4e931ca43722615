"""The report on a discovery: one page, its numbers as JSON, the improved model, plots and courses.

`write_report` writes the folder, `to_json` gives the numbers alone. `found` says what is missing,
`gaps`, `courses` and `left` how far the model is from the recordings, `model` what changed in it, `evidence` what
else was fitted and what was done; `words` writes numbers and names.
"""

from .as_json import to_json
from .write import Written, write_report

__all__ = ["Written", "to_json", "write_report"]
