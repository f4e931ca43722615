"""A model made ready to run: numeric functions of each structural mode, on demand.

Parameters are inputs of the functions, so one compiled model serves all values.
"""

from __future__ import annotations

import functools
import itertools
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy
import sympy

from ..causality import CausalGraph
from ..codegen.program import Program, ProgramError
from ..codegen.to_casadi import to_casadi
from ..codegen.to_numpy import to_numpy
from ..dimensions import infer
from ..elements import C, Storage
from ..equations import Equations, derive
from ..errors import BondGraphError
from ..graph import TIME, BondGraph
from ..modes import ModeEquations, contacts, mode_equations
from ..resolver import Resolver
from ..values import InitialState
from .buffered import PerThread
from .mode_set import ModeSet
from .smooth import SmoothFunctions, smooth_functions
from .stiffness import Probe
from .table import ModeFunctions, ModeTable

if TYPE_CHECKING:
    from .forward import ForwardModel

Array = numpy.ndarray

# Of so many all combinations are looked at, to say whether a run has to search its modes.
FEW_CONTACTS = 3


class CompiledModel:
    """A graph's equations with their numeric functions, reusable over runs.

    Modes are derived and compiled when a run first meets them, and kept here.

    Parameters
    ----------
    graph : BondGraph or CausalGraph

    Attributes
    ----------
    equations : Equations
        With all contacts slipping.
    modes : ModeTable
        Functions by structural mode: the bit mask of held contacts.
    mode_set : ModeSet
        Equations and functions of the modes.
    switched : bool
        Whether runs search their modes, on the virtual machine.
    resolver : Resolver
        Evaluates the parameter table.
    initial_state : InitialState
        Evaluates the initial state.

    Examples
    --------
    >>> from bondgraph.models import mass_on_belt
    >>> CompiledModel(mass_on_belt.graph()).contact_names
    ('contact',)
    """

    def __init__(self, graph: BondGraph | CausalGraph) -> None:
        self.equations = derive(graph)
        self.contact_names = contacts(self.equations.graph)
        self.resolver = Resolver(self.equations.graph.parameters)
        self.initial_state = InitialState(self.equations)
        looked_at = self._looked_at()
        self.switched = looked_at is None
        self.mode_set = self._modes_with_rates(looked_at or {})
        sizes = (len(self.equations.states), len(self.equations.inputs), len(self.contact_names))
        self.modes = ModeTable(*sizes, self._functions)
        self._signals: dict[tuple[int, tuple[str, ...]], Callable[..., Any]] = {}

    def _looked_at(self) -> dict[tuple[str, ...], ModeEquations] | None:
        """Return the modes of frictions by what sticks; None where a run has to search its modes.

        It has to where modes bind states, keep algebraic variables or exclude each other. Frictions
        that decide efforts beside explicit equations need none of that and run as compiled C.
        """
        equations, names = self.equations, self.contact_names
        if equations.switches or (equations.contacts and equations.algebraic):
            return None
        some = range(1, len(names) + 1) if len(names) <= FEW_CONTACTS else (1, len(names))
        found = {}
        for held in itertools.chain.from_iterable(itertools.combinations(names, k) for k in some):
            try:
                found[held] = mode_equations(equations, held)
            except BondGraphError:
                return None
            if found[held].equations.algebraic:
                return None
        return found

    def _modes_with_rates(self, looked_at: Mapping[tuple[str, ...], ModeEquations]) -> ModeSet:
        """Return the modes; rates of inputs that some mode may need are counted among the inputs."""
        equations = self.equations
        inputs = equations.graph.inputs
        needed = set(inputs) if self.switched else set()
        for mode in looked_at.values():
            needed.update(mode.equations.input_rates)
        rates = {s: sympy.Symbol(f"der({s.name})", real=True) for s in inputs if s in needed}
        rates |= equations.input_rates
        known = tuple(dict.fromkeys((*equations.inputs, *rates.values())))
        self.equations = replace(equations, inputs=known, input_rates=rates)
        return ModeSet(self.equations, known, equations.parameters, looked_at)

    def in_mask(self, mask: int) -> Equations:
        """Return the equations of a structural mode, derived on first use.

        Parameters
        ----------
        mask : int
            Bit j is set where contact j is held.
        """
        return self.mode_set.equations(mask).equations

    def compile(self) -> bool:
        """Wait for the machine code of what runs will need, as far as that can be foreseen.

        Runs need not wait for it: what is not in the cache is compiled behind while they
        go on on the virtual machine.

        Returns
        -------
        bool
            Whether runs of dopri5 are compiled; False for models that search their modes
            or keep algebraic variables, and where there is no compiler.

        Examples
        --------
        >>> from bondgraph.models import mass_on_belt
        >>> model = CompiledModel(mass_on_belt.graph())
        >>> model.compile() == (model.modes.refusal is None)
        True
        """
        if self.switched or self.equations.algebraic:
            return False
        k = len(self.contact_names)
        foreseen = range(1 << k) if k <= FEW_CONTACTS else (0, *(1 << j for j in range(k)))
        return self.modes.compile(foreseen)

    def signals(self, mask: int, names: tuple[str, ...]) -> Callable[..., Any]:
        """Return a NumPy function of named signals in a structural mode.

        Parameters
        ----------
        mask : int
        names : tuple of str
            Outputs, states, port variables such as ``mass.f``, parameters.

        Returns
        -------
        callable
            ``(t, x, u, p, s)``, each of shape (size, ...), to one array of
            shape (len(names), ...). Algebraic variables follow the states in x.
        """
        key = (mask, names)
        if key not in self._signals:
            equations = self.in_mask(mask)
            results = [self.expression(equations, name) for name in names]
            if self.contact_names:
                self._signals[key] = self.mode_set.signals(mask, results)
            else:
                function = to_numpy(self._program(equations, "signals", results))
                self._signals[key] = lambda *arguments: function(*arguments)[0]
        return self._signals[key]

    def expression(self, equations: Equations, name: str) -> sympy.Expr:
        """Return the expression behind a signal's name, or raise KeyError."""
        solved = {symbol.name: symbol for symbol in (*equations.states, *equations.algebraic)}
        for table in (equations.outputs, solved, equations.ports):
            if name in table:
                return table[name]
        for symbol in (*equations.inputs, *equations.parameters):
            if symbol.name == name:
                return symbol
        raise KeyError(name)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of all signals: outputs, states, inputs, port and algebraic variables."""
        equations = self.equations
        names = [
            *equations.outputs,
            *(symbol.name for symbol in (*equations.states, *equations.inputs)),
        ]
        implicit = (symbol.name for symbol in equations.algebraic)
        return tuple(dict.fromkeys([*names, *equations.ports, *implicit]))

    @functools.cached_property
    def units(self) -> Mapping[str, str | None]:
        """Inferred units of states and port variables, by name."""
        return infer(self.equations.graph).units

    @functools.cached_property
    def smooth(self) -> SmoothFunctions:
        """Functions for the integrators of smooth models, contacts and modes aside."""
        return smooth_functions(self.equations, self._parameters())

    @functools.cached_property
    def stiffness(self) -> Probe:
        """Tells how stiff a run will be; for models without switching elements."""
        return Probe(self)

    @functools.cached_property
    def measures(self) -> Callable[..., Array]:
        """Slopes of the states' own laws, then stored energy, from ``(t, x, u, p, s)``.

        A function of vectors to shape (n + 1,); the energy is NaN where a storage is modulated and
        has no potential. Laws whose potential is not known are integrated numerically from zero.
        Algebraic variables follow the states in x.
        """
        energies = self.equations.energies
        unknown = [name for name, energy in energies.items() if energy is None]
        tellable = all(self._has_own_law(name) for name in unknown)
        known = [energy for energy in energies.values() if energy is not None]
        closed = sympy.Add(*known) if tellable else sympy.nan
        program = self._program(self.equations, "measures", [*self._slopes(), closed])
        rest = [self._numeric_energy(name) for name in unknown] if tellable else []
        try:
            plain: Callable[..., Array] = PerThread(to_casadi(program))
        except ProgramError:  # an energy may have a form in NumPy alone
            wide = to_numpy(program)

            def plain(*given: Any) -> Array:
                return wide(*(numpy.reshape(item, (-1, 1)) for item in given))[0][:, 0]

        if not rest:
            return plain

        def with_rest(*given: Any) -> Array:
            found = plain(*given)
            columns = [numpy.reshape(item, (-1, 1)) for item in given]
            found[-1] += sum(float(part(*columns)[0]) for part in rest)
            return found

        return with_rest

    def measured(self, t: float, x: Array, u: Array, p: Array) -> tuple[float | None, Array]:
        """Return the stored energy, None where unknown, and each state's scale for unit energy.

        Parameters
        ----------
        t : float
        x, u, p : arrays
            Algebraic variables follow the states in x.
        """
        found = self.measures(t, x, u, p, numpy.ones(len(self.equations.contacts)))
        slopes, energy = found[:-1], float(found[-1])
        return None if energy != energy else energy, unit_scales(slopes)

    def _slopes(self) -> list[sympy.Expr]:
        """Return the slope of each state's own law; zero for a signal block, which holds no energy."""
        equations = self.equations
        elements = {f"{name}.{_letter(item)}": item for name, item in equations.graph.of(Storage)}
        local = equations.own_symbols
        slopes = []
        for state in equations.states:
            element = elements.get(state.name)
            if element is None:
                slopes.append(sympy.S.Zero)
                continue
            slope = sympy.diff(element.law, element.state).xreplace(local)
            # a law that jumps has no slope there that a number could tell
            slopes.append(slope.replace(sympy.DiracDelta, lambda *_: sympy.S.Zero))
        return slopes

    def _has_own_law(self, name: str) -> bool:
        element = self.equations.graph.elements[name]
        assert isinstance(element, Storage)
        return not element.law.free_symbols - {element.state} - set(self.equations.graph.parameters)

    def _numeric_energy(self, name: str) -> Callable[..., Array]:
        element = self.equations.graph.elements[name]
        assert isinstance(element, Storage)
        p = self.equations.parameters
        law = to_numpy(
            Program("law", (("q", (element.state,)), ("p", p)), (), (("e", (element.law,)),))
        )
        state_program = self._program(
            self.equations, "state", [self.expression(self.equations, f"{name}.{_letter(element)}")]
        )
        state = to_numpy(state_program)
        nodes, weights = numpy.polynomial.legendre.leggauss(32)

        def energy(*arguments: Any) -> Array:
            q = state(*arguments)[0][0]
            points = 0.5 * q[..., None] * (nodes + 1)
            parameters = numpy.asarray(arguments[3])
            values = law(points[None], parameters.reshape(-1, *([1] * points.ndim)))[0][0]
            return 0.5 * q * (values * weights).sum(axis=-1)

        return energy

    @functools.cached_property
    def forward(self) -> ForwardModel:
        """Derivatives of modes, parameter table and signals, for `sensitivities`."""
        from .forward import ForwardModel

        return ForwardModel(self)

    def signal_program(self, mask: int, results: Iterable[sympy.Expr]) -> Program:
        """Return signals in a structural mode as a program in ``(t, x, u, p, s, ...)``."""
        if self.contact_names:
            return self.mode_set.program(mask, "signals", {"out": list(results)})
        return self._program(self.in_mask(mask), "signals", results)

    def _functions(self, mask: int) -> ModeFunctions:
        rhs, guard = self.mode_set.calm(mask)
        return ModeFunctions(rhs, guard if self.contact_names else None)

    def _program(self, equations: Equations, name: str, results: Iterable[sympy.Expr]) -> Program:
        return Program.pruned(
            name,
            [
                ("t", [TIME]),
                ("x", (*equations.states, *equations.algebraic)),
                ("u", equations.inputs),
                ("p", self._parameters()),
                ("s", equations.directions),
            ],
            equations.assignments,
            {"out": results},
        )

    def _parameters(self) -> tuple[sympy.Symbol, ...]:
        """The parameter vector is the same in all modes."""
        return self.equations.parameters


def unit_scales(slopes: Array) -> Array:
    """Return how large states become for unit energy, from the slopes of their laws; 0 where unknown.

    Examples
    --------
    >>> unit_scales(numpy.array([4.0, 0.0])).tolist()
    [0.5, 0.0]
    """
    usable = (slopes > 0) & (slopes < numpy.inf)
    return numpy.where(usable, 1 / numpy.sqrt(numpy.where(usable, slopes, 1.0)), 0.0)


def _letter(element: Storage) -> str:
    return "q" if isinstance(element, C) else "p"
