"""The model of a robot: every quantity in closed form, computed once when asked for, as plain SymPy."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any

from derive.errors import QuantityError
from derive.lecture.point import at_point
from derive.lecture.sympy_conversion import Expr
from derive.model.abbreviations import abbreviate
from derive.model.decoupling import Decoupling, find_decoupling
from derive.model.dynamic_model import DynamicModel
from derive.model.ends import OfEnds
from derive.model.equality import verdict
from derive.model.quantities import DESCRIBED
from derive.model.quantity_names import evaluate, parse
from derive.robot.cells import typed_point
from derive.robot.rounding import DIGITS

if TYPE_CHECKING:  # the inverse kinematics takes long to import
    from derive.model.closure import Closure


class Model(DynamicModel):
    """Closed forms of one robot.

    Every quantity is an immutable SymPy matrix or an expression in the robot's own symbols, which are plain
    ``sympy.Symbol``s; ``qd1`` and ``qdd1`` are velocity and acceleration of ``q1``. Matrices of the end effector are in
    the world frame unless they say otherwise, lengths in metres, angles in radians.

    Args:
        robot: The robot.
        style: How expressions are grouped: a `Style`, the name of a set of options (``compact``, ``by-geometry``,
            ``expanded``) or options by name, see `Style.of`; default as the file says.
        contraction: Which sums of angles are contracted: ``aligned`` or ``opposed``; default as the file says.

    Attributes:
        robot: The robot.
        style: How expressions are grouped.
        q: Joint variables [rad or m].
        qd: Their velocities.
        qdd: Their accelerations.
    """

    @cached_property
    def decoupling(self) -> Decoupling:
        """Which entries of B beside the diagonal are zero, and with which lengths, masses and inertias all are.

        Spong, Hutchinson and Vidyasagar, Robot Modeling and Control, 2006, chapter on dynamics.
        """
        return find_decoupling(self)

    def abbreviated(self, quantity: str, by: str | None = None) -> tuple[Expr, Mapping[Expr, Expr]]:
        """A dynamic quantity with short names, and what the names mean.

        Args:
            quantity: ``B``, ``C``, ``N``, ``Bdot``, ``g`` or ``tau``.
            by: ``christoffel`` (default for C, N, Bdot and tau) names the Christoffel symbols, ``h*(qd1 + qd2)``;
                ``coefficients`` (default for B and g) names the linear combinations of constants, ``a1 + 2*a2*c2``.

        Returns:
            The matrix, and symbol to expression for every name in it.

        Raises:
            QuantityError: No such quantity or way.
        """
        row, indices, entry = parse(self, quantity)
        return abbreviate(self, row.name if not indices and entry is None else quantity, by)

    @cached_property
    def closure(self) -> Closure:
        """How the passive joints of closed loops follow the variables: positions, and the derivatives G and H.

        Raises:
            QuantityError: The robot has no loops, or one that cannot be solved in closed form.
        """
        if not self.robot.passive:
            remedy = "write loops: in the robot file; those of parallelograms are coupled joints, without G and H"
            raise QuantityError(f"closed loops of {self.robot.name}, which has none", remedy=remedy)
        from derive.model.closure import find_closure

        return find_closure(self)

    def quantity(self, name: str) -> Expr:
        """A quantity by its name.

        Args:
            name: As `derive show` takes it, for instance ``T[1,4]`` or ``christoffel[1,1,2]``.

        Returns:
            The matrix or expression; of ``workspace`` and ``aspects`` what describes them.

        Raises:
            QuantityError: No such quantity or entry.
        """
        return getattr(self, name) if name in DESCRIBED else evaluate(self, name)

    def at(
        self,
        quantity: str,
        q: Sequence[float | str] = (),
        *,
        qd: Sequence[float | str] = (),
        qdd: Sequence[float | str] = (),
        values: Mapping[str, float | str] | None = None,
        exact: bool = False,
        digits: int | None = DIGITS,
    ) -> Expr:
        """A quantity in numbers, as ``derive show --at`` prints it; for many points generated functions are faster.

        Args:
            quantity: Its name, as `quantity` takes it.
            q: Joint values, numbers or cells such as ``"pi/4"``, in the units of the robot file.
            qd: Velocities, in these units per second.
            qdd: Accelerations, likewise.
            values: Numbers by name: symbols as under ``parameters:``, single joints, rates. Symbols that the file gives
                a number have it.
            exact: Whether roots and pi stay what they are.
            digits: Significant digits of the numbers where symbols stay; None for thirty.

        Returns:
            The matrix or expression, its numbers rationals of thirty digits. Symbols without a number stay, and
            the numbers are then decimals of ``digits``, as ``derive show --at`` prints them.

        Raises:
            DeriveError: Not one value per joint, a name that the robot has not, or a value that is no number.
            QuantityError: No such quantity, or it has no finite real value there.
        """
        orders = [",".join(map(str, order)) for order in (q, qd, qdd)]
        named = [f"{name}={value}" for name, value in (values or {}).items()]
        point = typed_point(self.robot, [*filter(None, orders[:1]), *named], *orders[1:])
        point = self.closure.completed(point) if self.robot.passive else point
        found = evaluate(self, quantity)

        def _there(value: Any) -> Expr:
            if hasattr(value, "at"):  # inverse kinematics
                return value.at(point)
            return at_point(value, values=point, name=quantity, exact=exact, digits=digits)

        return found.each(_there) if isinstance(found, OfEnds) else _there(found)

    def equal(self, quantity: str, expression: object) -> bool:
        """Whether an expression equals a scalar quantity identically, wherever both are defined.

        Args:
            quantity: A scalar quantity such as ``T[1,4]``.
            expression: Text in the notation of lecture notes (c12, qd1, ...) or a SymPy expression.

        Raises:
            QuantityError: No such quantity.
            CheckError: The expression cannot be read.
        """
        return verdict(self, quantity, expression).equal
