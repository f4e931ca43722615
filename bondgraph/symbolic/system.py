"""The symbolic analysis of a small model as a frozen value."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

import sympy

from ..codegen.to_latex import align, latex, latex_name, latex_names
from ..graph import TIME
from ..parameters import unknown_name
from .limits import Budget, SymbolicError
from .pencil import characteristic_factors, transfer_quotient
from .polynomial import Polynomial, monic, read
from .rational import Poly, Polynomials
from .routh import RouthHurwitz, conditions_of
from .transfer import TransferFunction


@dataclass(frozen=True, eq=False)
class SymbolicSystem:
    """State equations in symbols, and their linearisation ``dx/dt = A x + B u``, ``y = C x + D u``.

    Attributes
    ----------
    name : str
    states, inputs : tuple of Symbol
    parameters : tuple of Symbol
        All other symbols that occur.
    rates : mapping of Symbol to Expr
        Rate of each state, expanded.
    outputs : mapping of str to Expr
    algebraic : tuple of Symbol
        Variables that stay implicit in `rates` and `outputs`. They are
        eliminated from the Jacobians, whose entries may still hold their values.
    residuals : tuple of Expr
        Each is zero; they define `algebraic`.
    at : mapping of Symbol to Expr
        The operating point, as far as it was given; other states and inputs
        stand in the Jacobians as themselves.
    drift : mapping of Symbol to Expr
        Rates at that point: zero in equilibrium.
    A : (n, n) ImmutableMatrix
        Ordered as `states`, in SI.
    B : (n, m) ImmutableMatrix
    C : (k, n) ImmutableMatrix
    D : (k, m) ImmutableMatrix
    input_rates : mapping of Symbol to Symbol
        Input to its rate, an input of its own in B and D, where a dependent storage needs it.

    Examples
    --------
    >>> from bondgraph import C, I, One, R, Se, assemble, symbolic_system
    >>> m, b, k = sympy.symbols("m b k", positive=True)
    >>> F, v = sympy.Symbol("F", real=True), One("v")
    >>> parts = I("mass", m), C("spring", stiffness=k), R("damper", b)
    >>> graph = assemble("msd", Se("push", F) >> v >> parts, inputs=[F], outputs={"x": parts[1].q})
    >>> system = symbolic_system(graph)
    >>> system.A
    Matrix([
    [-b/m, -k],
    [ 1/m,  0]])
    >>> print(system.transfer_function("x", "F"))
    (1) / (m*s^2 + b*s + k)
    """

    name: str
    states: tuple[sympy.Symbol, ...]
    inputs: tuple[sympy.Symbol, ...]
    parameters: tuple[sympy.Symbol, ...]
    rates: Mapping[sympy.Symbol, sympy.Expr]
    outputs: Mapping[str, sympy.Expr]
    algebraic: tuple[sympy.Symbol, ...]
    residuals: tuple[sympy.Expr, ...]
    at: Mapping[sympy.Symbol, sympy.Expr]
    drift: Mapping[sympy.Symbol, sympy.Expr]
    A: sympy.ImmutableMatrix
    B: sympy.ImmutableMatrix
    C: sympy.ImmutableMatrix
    D: sympy.ImmutableMatrix
    input_rates: Mapping[sympy.Symbol, sympy.Symbol] = field(default_factory=dict)

    @property
    def s(self) -> sympy.Symbol:
        """The Laplace variable: ``s``, or ``lambda`` where a symbol of the model is called s."""
        taken = {symbol.name for symbol in self._symbols()}
        free = (name for name in ("s", "lambda", "p_s", "s_") if name not in taken)
        return sympy.Symbol(next(free, "s"))

    def characteristic_polynomial(self, s: sympy.Symbol | None = None) -> Polynomial:
        """Return ``det(s I - A)``.

        Parameters
        ----------
        s : Symbol, optional

        Returns
        -------
        Polynomial
            Its leading coefficient is one.

        Raises
        ------
        SymbolicError
            When it is too large, or A depends on time.
        """
        space, factors = self._factors()
        product = _product(space, factors)
        return monic(product, space, s or self.s, names=self.names)

    def poles(self) -> dict[sympy.Expr, int]:
        """Return the eigenvalues of A and their multiplicity, 1/s, where they have a closed form.

        Returns
        -------
        dict of Expr to int

        Raises
        ------
        SymbolicError
            Where states of more than second order move together.
        """
        space, factors = self._factors()
        found: dict[sympy.Expr, int] = {}
        for factor in factors:
            for root, often in read(factor, space, self.s).roots().items():
                found[root] = found.get(root, 0) + often
        return found

    def routh_hurwitz(self, s: sympy.Symbol | None = None) -> RouthHurwitz:
        """Return the conditions in the parameters for asymptotic stability.

        Parameters
        ----------
        s : Symbol, optional

        Returns
        -------
        RouthHurwitz

        Raises
        ------
        SymbolicError
            When they are too large.
        """
        space, factors = self._factors()
        return conditions_of(space, factors, s or self.s, self.names)

    def transfer_function(
        self, output: str, input: str | sympy.Symbol, s: sympy.Symbol | None = None
    ) -> TransferFunction:
        """Return the transfer function from an input to an output.

        Where the equations need the input's rate, that is s times the input.

        Parameters
        ----------
        output : str
        input : str or Symbol
        s : Symbol, optional

        Returns
        -------
        TransferFunction

        Raises
        ------
        ParameterError
            For names that are not known.
        SymbolicError
            When it is too large, or a Jacobian depends on time.
        """
        self._check_time()
        row, source = self._output(output), self._input(input)
        columns = []
        for symbol in self._with_rates(source):
            place = self.inputs.index(symbol)
            columns.append((self.B[:, place], self.D[row, place]))
        space, top, bottom = transfer_quotient(self.A, columns, self.C[row, :])
        s = s or self.s
        return TransferFunction(
            output,
            source.name,
            read(top, space, s, names=self.names),
            read(bottom, space, s, names=self.names),
        )

    def transfer_matrix(self, s: sympy.Symbol | None = None) -> sympy.ImmutableMatrix:
        """Return all transfer functions.

        Parameters
        ----------
        s : Symbol, optional

        Returns
        -------
        ImmutableMatrix
            Row: output; column: input, without rates of inputs.
        """
        sources = self.sources
        rows = [
            [self.transfer_function(name, source, s).expression for source in sources]
            for name in self.outputs
        ]
        return sympy.ImmutableMatrix(
            len(rows), len(sources), [item for row in rows for item in row]
        )

    def dcgain(self, output: str, input: str | sympy.Symbol) -> sympy.Expr:
        """Return a transfer function's value at s = 0.

        Parameters
        ----------
        output : str
        input : str or Symbol

        Returns
        -------
        Expr
            ``zoo`` where there is a free integrator.
        """
        return self.transfer_function(output, input).dcgain()

    @property
    def sources(self) -> tuple[sympy.Symbol, ...]:
        """The inputs, without rates of inputs."""
        rates = set(self.input_rates.values())
        return tuple(symbol for symbol in self.inputs if symbol not in rates)

    @property
    def names(self) -> dict[sympy.Basic, str]:
        """LaTeX of every symbol."""
        return latex_names(self._symbols())

    def to_latex(self) -> str:
        """Write state equations, outputs and Jacobians as LaTeX.

        Returns
        -------
        str
            One ``align*`` environment for amsmath or MathJax.
        """
        names = self.names
        rows = [(latex_name(state.name, dots=1), rate) for state, rate in self.rates.items()]
        rows += [("0", residual) for residual in self.residuals]
        rows += [(latex_name(name), value) for name, value in self.outputs.items()]
        rows += [(latex(symbol, names), value) for symbol, value in self.at.items()]
        blocks = {"A": self.A, "B": self.B, "C": self.C, "D": self.D}
        rows += [(name, matrix) for name, matrix in blocks.items() if matrix.rows and matrix.cols]
        return align(rows, names)

    def _repr_latex_(self) -> str:
        return self.to_latex()

    def _symbols(self) -> list[sympy.Symbol]:
        return [*self.states, *self.inputs, *self.algebraic, *self.parameters]

    def _factors(self) -> tuple[Polynomials, list[Poly]]:
        self._check_time()
        return characteristic_factors(self.A)

    def _check_time(self) -> None:
        if any(TIME in matrix.free_symbols for matrix in (self.A, self.B, self.C, self.D)):
            raise SymbolicError(
                f"the Jacobians of {self.name!r} depend on time: there is no characteristic polynomial "
                f"and no transfer function; make what depends on time an input"
            )

    def _output(self, name: str) -> int:
        if name not in self.outputs:
            raise unknown_name("output", name, self.outputs)
        return list(self.outputs).index(name)

    def _input(self, given: str | sympy.Symbol) -> sympy.Symbol:
        name = given.name if isinstance(given, sympy.Symbol) else given
        known = {symbol.name: symbol for symbol in self.sources}
        if name not in known:
            raise unknown_name("input", name, known)
        return known[name]

    def _with_rates(self, symbol: sympy.Symbol) -> Iterable[sympy.Symbol]:
        while True:
            yield symbol
            if symbol not in self.input_rates:
                return
            symbol = self.input_rates[symbol]


def _product(space: Polynomials, factors: Iterable[Poly]) -> Poly:
    budget = Budget("the characteristic polynomial")
    product = space.ring.one
    for factor in factors:
        budget.spend(len(product) * len(factor))
        product = product * factor
        budget.check(len(product))
    return space.normal(product)
