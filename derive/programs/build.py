"""The program of a robot: every function's cheapest formulation, as a tape."""

from __future__ import annotations

from collections.abc import Callable, Container, Sequence
from dataclasses import dataclass, replace
from operator import methodcaller
from typing import TYPE_CHECKING, Any

from derive.errors import QuantityError, listed
from derive.programs.formulations.choice import Formulation, FormulationChoice
from derive.programs.formulations.trace import Trace
from derive.programs.functions import INTERFACES, ROWS, FunctionRow
from derive.programs.optimise.search_policy import Effort
from derive.programs.program import Column, EndInverse, Function, Interface, Inverse, InverseSearch, Program
from derive.programs.tape.build import program_cost
from derive.programs.tape.value import PASSIVE
from derive.robot import tree
from derive.robot.names import free_symbols
from derive.robot.robot import Robot
from derive.robot.task_rows import task_rows
from derive.robot.tree import is_arm

if TYPE_CHECKING:
    from derive.programs.inverse import Solved

# How pieces of work that do not depend on each other are done at once: the work, the pieces and their sizes.
Spread = Callable[[Callable[[Any], Any], Sequence[Any], Sequence[int]], Sequence[Any]]


def build_program(
    robot: Robot,
    effort: Effort = Effort.FULL,
    *,
    names: Container[str] = frozenset(INTERFACES),
    inverse: bool = False,
    spread: Spread | None = None,
) -> Program:
    """The functions of a robot: kinematics, and dynamics where the file has links; ``spread`` changes no program."""
    # All are traced on one graph; then the cheapest formulation of each is chosen, independently of the others.
    trace = Trace(robot, effort)
    rows = [row for row in ROWS if row.interface.name in names and row.exists(robot)]
    ends = [end.name for end in robot.ends if end.name] or [""]
    work: list[_Traced | _Inverse] = []
    work += [_Traced.of(row, trace, end) for row in rows for end in (ends if row.of_end else [""])]
    if inverse and is_arm(robot):
        work.append(_Inverse(trace))
    elif inverse and robot.root is None:
        work += [_Inverse(Trace(tree.arm(robot, end)[0], effort), end) for end in ends if end]
    sizes = [piece.size for piece in work]
    results = list(spread(methodcaller("result"), work, sizes) if spread else [piece.result() for piece in work])
    functions = tuple(result for result in results if isinstance(result, Function))
    solved = [(piece.end, result) for piece, result in zip(work, results, strict=True) if isinstance(piece, _Inverse)]
    without = f"the {'root moves' if robot.root else 'table is a tree'}" if inverse and not is_arm(robot) else ""
    found, reason = next((result for end, result in solved if not end), (None, without))
    closed = found if isinstance(found, Inverse) else None
    search = found if isinstance(found, InverseSearch) else None
    of_ends = []
    for end, own in [(end, own) for end, (own, _) in solved if end and isinstance(own, Inverse)]:
        function, step = (replace(each, interface=each.interface.at(end)) for each in (own.function, own.step))
        of_ends.append(EndInverse(end, *tree.arm(robot, end), replace(own, function=function, step=step)))
    return Program(functions, free_symbols(robot), closed, reason, search, tuple(of_ends))


@dataclass(frozen=True, slots=True)
class _Inverse:
    """Inverse kinematics, which is derived in a place of its own."""

    trace: Trace
    end: str = ""  # of a tree; the trace is that of the arm to it
    size = 5_000  # as long as a search among so many operations: 0.3 s of the 1.7 s of a PUMA 560's program

    def result(self) -> Solved:
        from derive.programs.inverse import solved  # forty modules, which a motion in joint variables does not need

        return solved(self.trace)


@dataclass(frozen=True, slots=True)
class _Traced:
    """A function whose formulations stand on the graph; none where none has a value.

    Cells without a value are refused by the functions that must have one: elsewhere a division by zero is that of
    singular angles, or of an inertia matrix that is singular everywhere.
    """

    row: FunctionRow
    trace: Trace
    columns: tuple[Column, ...]
    formulations: tuple[Formulation, ...]
    interface: Interface
    size: int  # operations among which is searched

    @classmethod
    def of(cls, row: FunctionRow, trace: Trace, end: str = "") -> _Traced:
        """Trace a function, one of an end of a tree where that has a name."""
        columns = row.columns(trace) if row.columns else ()
        interface = row.interface.at(end) if end else row.interface
        if trace.passive.is_given:
            interface = _with_passive(interface)
        try:
            own = trace.to_end(end)[0] if end else trace
            formulations = trace.choice.near(row.formulations(own), row.margin)
            if end or trace.robot.coupled:
                sizes = {"r": trace.n, "p": len(columns), "u": len(trace.robot.passive) + trace.passive.is_given}
                formulations = tuple(own.for_variables(f, interface.shape, sizes) for f in formulations)
        except QuantityError:
            if not row.may_lack_value:
                raise
            formulations = ()
        nodes = sum(program_cost(trace.graph, [v.ref for v in f.trace()]).nodes for f in formulations)
        return cls(row, trace, columns, formulations, interface, (4 if row.search else 1) * nodes)

    def result(self) -> Function | None:
        """The function with its tape; None for an optional one without a value in any configuration."""
        row, choice = self.row, self.trace.choice
        if self.size > row.most_improved:
            choice = FormulationChoice(self.trace.robot, self.trace.graph, Effort.QUICK)
        try:
            chosen = choice.cheapest(self.formulations, search=row.search) if self.formulations else None
        except QuantityError:
            if not row.may_lack_value:
                raise
            chosen = None
        if chosen is None and row.without_value is not None:
            chosen = choice.cheapest([row.without_value(self.trace)])
        if chosen is None:
            return None
        passive, is_given = len(self.trace.robot.passive), self.trace.passive.is_given
        sizes = {"n": self.trace.robot.dof, "r": self.trace.n, "p": len(self.columns), "u": passive + is_given}
        sizes |= {"m": len(task_rows(self.trace.robot))} if "m" in self.interface.shape else {}
        interface = self.interface
        shape = tuple(sizes[size] if isinstance(size, str) else size for size in interface.shape)
        formulation, tape = chosen
        if any(isinstance(link.coulomb, tuple) for link in self.trace.robot.links):
            result = interface.result.replace("coulomb*sign(qd)", "(coulomb of the direction)*sign(qd)")
            interface = replace(interface, result=result)
        if passive:
            names = listed([joint.variable for joint in self.trace.robot.passive])
            interface = replace(interface, result=interface.result.replace("each passive joint", names))
        widths = {PASSIVE: passive} if is_given else {}
        return Function(interface, shape, tape, formulation.words, self.columns, widths)


def _with_passive(interface: Interface) -> Interface:
    """A function that takes the positions of passive joints, or where these are looked for."""
    interface = replace(interface, arguments=(*interface.arguments, PASSIVE))
    if interface.name != "passive_positions":
        return interface
    result = "each passive joint [rad, m] nearest to q_p, and by how much loops are open then [m, and entries of R]"
    return replace(interface, symbol="found", result=f"of {result}; call it again with these where that is not zero")
