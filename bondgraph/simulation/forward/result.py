"""Sensitivities: what comes out, addressed by name."""

from __future__ import annotations

from dataclasses import dataclass

import numpy

from ...parameters import Parameter, unknown_name
from ...units import si_unit
from ..inputs import at
from ..trajectory import Trajectory

Array = numpy.ndarray


@dataclass(frozen=True, eq=False)
class Sensitivities:
    """Derivatives of a run by parameters and initial states.

    Those of any state, output or port variable are had by name, at fixed time:
    ``found["x_c"]`` has the shape (q, nt), in the order of `wrt`.

    Attributes
    ----------
    trajectory : Trajectory
        The run itself, as `bondgraph.simulate` gives it.
    wrt : tuple of str
        The q parameters and states.
    x : (n, q, nt) array
        Of the states at the times of the trajectory, ordered as its rows. Where it
        has two rows at one time, before and after an event, so has this.
    x_end : (n, q) array
        Of the last good state.
    events : (ne, q) array
        Of the event times, in the order of ``trajectory.events``, in s per unit.
    z : (nz, q, nt) array
        Of the algebraic variables.
    seeds : (np, q) array
        Of the parameters of the equations: how each moves with what is in `wrt`.

    Examples
    --------
    >>> from bondgraph import sensitivities
    >>> from bondgraph.models import mass_on_belt
    >>> found = sensitivities(mass_on_belt.graph(), 1.0, ["v_b", "spring.q"])
    >>> found["slip"].shape == (2, len(found.trajectory.t)), found.unit("x", "v_b")
    (True, 'm/(m/s)')
    """

    trajectory: Trajectory
    wrt: tuple[str, ...]
    x: Array
    x_end: Array
    events: Array
    z: Array
    seeds: Array

    def __getitem__(self, name: str) -> Array:
        """Return the derivatives of a signal at all times, of shape (q, nt)."""
        run = self.trajectory
        name = str(getattr(name, "name", name))
        out = numpy.zeros((len(self.wrt), len(run.t)))
        if name in self.wrt and name not in run.states:  # the parameter itself
            out[self.wrt.index(name)] = 1.0
            return out
        p = numpy.array([run.parameters[s.name] for s in run.model.equations.parameters])
        x = numpy.concatenate([run.x, run.z]) if len(run.z) else run.x
        moved = numpy.concatenate([self.x, self.z]) if len(self.z) else self.x
        u = at(run.inputs, run.t)
        masks = ((run.codes == 0) * (1 << numpy.arange(run.codes.shape[1]))).sum(axis=1)
        for mask in numpy.unique(masks.astype(int)):
            here = masks == mask
            count = int(here.sum())
            place = (
                run.t[None, here],
                x[:, here],
                u[:, here],
                numpy.repeat(p[:, None], count, axis=1),
                run.codes[here].T.astype(float),
            )
            out[:, here] = run.model.forward.signals(
                int(mask), name, place, moved[:, :, here], self.seeds
            )
        return out

    def __repr__(self) -> str:
        run = self.trajectory
        return f"Sensitivities(by {', '.join(self.wrt)}; {run!r})"

    def unit(self, name: str, wrt: str) -> str:
        """Return the unit of the derivative of a signal by a parameter or an initial state.

        Parameters
        ----------
        name : str
            A signal, or ``"t"`` for the times of events.
        wrt : str

        Returns
        -------
        str
            Empty where neither has a unit, or none is known.

        Raises
        ------
        ParameterError
            For one that is not in `wrt`.
        """
        if wrt not in self.wrt:
            raise unknown_name("sensitivity by", wrt, self.wrt)
        run = self.trajectory
        rows = {symbol.name: row for symbol, row in run.model.equations.graph.parameters.items()}
        below = si_unit(rows.get(wrt, Parameter()).unit) or run.unit(wrt)
        above = "s" if name == "t" else run.unit(name)
        return f"{above or '1'}/({below})" if below else above
