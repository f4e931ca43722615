"""Transients of netlists by the ngspice program, in batch mode.

The tolerances are tight and ``gmin``, the conductance that ngspice adds across each junction, is
taken away, so that a diode is Shockley's law alone.
"""

from __future__ import annotations

import subprocess
from pathlib import Path

import numpy as np

# k T / q at 27 C, with the k and q of CODATA 2014 that ngspice holds
THERMAL_VOLTAGE = 1.38064852e-23 * 300.15 / 1.6021766208e-19

DECK = """{title}
{netlist}
.options reltol=1e-7 abstol=1e-13 vntol=1e-9 chgtol=1e-18 gmin=1e-20 temp=27 tnom=27 method=trap
.control
set numdgt=15
set wr_singlescale
tran {step!r} {until!r} 0 {step!r} uic
wrdata {file} {vectors}
quit
.endc
.end
"""


def transient(
    netlist: str, vectors: tuple[str, ...], *, until: float, step: float, folder: Path
) -> np.ndarray:
    """Run ngspice from the initial conditions that the netlist states.

    Parameters
    ----------
    netlist : str
        Element and model lines.
    vectors : tuple of str
        What to report, such as ``v(out)`` or ``i(L1)``.
    until, step : float
        End of the run and the longest step, s.
    folder : Path
        Where its files may be written.

    Returns
    -------
    (1 + len(vectors), nt) array
        Times, increasing and as ngspice chose them, and the vectors.
    """
    answer = folder / "answer.txt"
    deck = folder / "deck.cir"
    deck.write_text(
        DECK.format(
            title="halfarrow",
            netlist=netlist,
            step=step,
            until=until,
            file=answer.name,
            vectors=" ".join(vectors),
        )
    )
    done = subprocess.run(
        ["ngspice", "-b", "-n", deck.name],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
    )
    assert answer.exists(), done.stdout[-2000:] + done.stderr[-2000:]
    rows = np.loadtxt(answer)
    assert rows[-1, 0] >= until * (1 - 1e-9), f"ngspice stopped at {rows[-1, 0]} s: {done.stderr}"
    # after a breakpoint ngspice may report one time twice
    return rows[np.append(True, np.diff(rows[:, 0]) > 0)].T
