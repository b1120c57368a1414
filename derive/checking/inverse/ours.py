"""The derived solution beside a printed one: our formula for each line, its form, and the names of branches."""

import math
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import suppress
from functools import cached_property
from itertools import product

import numpy as np
import sympy

from derive.checking.formulas.branches import SIGN
from derive.checking.inverse.poses import PoseNames, geometry_symbols
from derive.checking.inverse.printed import Place, PrintedFormula, PrintedInverse, PrintedLine, free_joints
from derive.errors import CheckError, DeriveError
from derive.handouts.notation.notation import Notation
from derive.handouts.notation.solution_printer import SignPrinter, pose_names, with_names
from derive.inverse.closed.solve import Freedom
from derive.inverse.words.elementary import PrintedLine as OurLine
from derive.inverse.words.elementary import with_lines
from derive.inverse.words.solutions import InverseKinematics, inverse_kinematics
from derive.lecture.sympy_conversion import expression_from_sympy
from derive.model.equality import Shape, form_of
from derive.model.model import Model
from derive.robot.expression import Expression, Name, names, substitute
from derive.robot.options.inverse import Task


class OurSolution:
    """The derived solution for the task of a printed one; task None where the names of the text say it."""

    def __init__(
        self, model: Model, printed: PrintedInverse, pose: PoseNames, task: Task | None, places: Sequence[Place]
    ) -> None:
        self._model, self._printed, self._pose, self._asked, self._places = model, printed, pose, task, places

    @cached_property
    def inverse(self) -> InverseKinematics | None:
        """The solution; None where there is none."""
        model, robot = self._model, self._model.robot
        with suppress(DeriveError):
            task = self._asked or robot.inverse.task
            # the task that the names in the text say, if it determines the joints: a planar pose is the whole pose
            rows = self._pose.rows
            if self._asked is None and rows and "phi" not in rows and Freedom(robot, rows).rank == robot.n:
                task = rows
            rank = Freedom(robot, task).rank
            free = free_joints(self._printed)
            # a task that leaves joints free needs those to be given which the printed solution takes as known
            given = [k for k, joint in enumerate(robot.joints) if joint.variable in free]
            if task == robot.inverse.task and (rank == robot.n or len(given) != robot.n - rank):
                return model.inverse
            return inverse_kinematics(robot, model.style, task, tuple(given) if rank < robot.n else None)
        return None

    @property
    def count(self) -> int:
        """The number of its solutions; 0 where it is not known."""
        return self.inverse.count if self.inverse is not None else 0

    @property
    def given(self) -> tuple[str, ...]:
        """Joint variables that it is given."""
        robot = self._model.robot
        return () if self.inverse is None else tuple(robot.joints[k].variable for k in self.inverse.graph.given)

    @cached_property
    def _lines(self) -> Mapping[str, OurLine]:
        return {} if self.inverse is None else {str(line.symbol): line for line in self.inverse.lines}

    @cached_property
    def _forms(self) -> Collection[tuple[object, Shape]]:
        """The forms of our formulas, named quantities put in."""
        joints = {joint.variable for joint in self._model.robot.joints}
        known: dict[str, Expression] = {}
        forms = set()
        for name, line in self._lines.items():
            signs = {sign.name: Name(SIGN) for sign in line.signs}
            with suppress(DeriveError):
                whole = substitute(substitute(expression_from_sympy(line.value), signs), known)
                forms.add(form_of(substitute(whole, self._twins)))
                if name.isidentifier() and name not in joints:
                    known[name] = whole
        return forms

    def has_form(self, formula: PrintedFormula) -> bool:
        """Whether a printed formula is one of ours but for names."""
        if self.inverse is None:
            return False
        pose, printed = self.inverse.pose, self._printed
        known: dict[str, Expression] = {n: Name(str(pose[i - 1, j - 1])) for n, (i, j) in self._pose.entries.items()}
        for line in printed.lines:
            if line.target is None and len(line.formulas) == 1:
                with suppress(CheckError):
                    for part in (*printed.named_before(line), line):
                        known[part.name] = substitute(part.formulas[0].expression, known)
        whole = substitute(formula.expression, known)
        # every plus-minus counts as the same one: forms are compared up to the choice of signs
        signs = {name: Name(SIGN) for name in names(whole) if name[0] == SIGN}
        return form_of(substitute(substitute(whole, signs), self._twins)) in self._forms

    @cached_property
    def _twins(self) -> Mapping[str, Expression]:
        """Entries of the pose by the first one that is the same at every reachable pose, as r21 = r12 of a SCARA."""
        assert self.inverse is not None, "it has formulas"
        cells, pose = product(range(3), range(4)), self.inverse.pose
        columns = {str(pose[i, j]): np.array([place.pose[i][j] for place in self._places]) for i, j in cells}
        # entries that agree at all configurations that were tried are equal as functions of the joints
        first = ((a, next(b for b, other in columns.items() if np.allclose(x, other))) for a, x in columns.items())
        return {a: Name(b) for a, b in first if a != b}

    def text(self, line: PrintedLine) -> str:
        """Our formula for what a line gives, with what it names; empty where there is none."""
        name = line.target.name if isinstance(line.target, Name) else ""
        if name not in self._lines or self.inverse is None:
            return ""
        robot = self._model.robot
        printer = SignPrinter(robot, with_names(Notation.of(robot), self.inverse), pose_names(self.inverse))
        joints = {joint.variable for joint in robot.joints}
        found = {name: " or ".join(map(printer.doprint, self._lines[name].alternatives))}
        waiting = [self._lines[name].value]
        while waiting:
            for symbol in sorted(waiting.pop().free_symbols, key=str):
                if (other := str(symbol)) in self._lines and other not in found and other not in joints:
                    found[other] = f"{other} = {printer.doprint(self._lines[other].value)}"
                    waiting.append(self._lines[other].value)
        return ", ".join(found.values())

    def met(self, places: Sequence[Place], is_met: Callable[[Place], bool]) -> tuple[int, tuple[str, ...]]:
        """How many of the solutions of a pose are given, and the names of the branches that never are."""
        if self.inverse is None or not self.inverse.is_explicit:
            return 0, ()
        counts = [0] * len(places)
        missing = []
        for name, reached in self._solutions_at(self.inverse, places):
            hits = [place is not None and is_met(place) for place in reached]
            counts = [count + hit for count, hit in zip(counts, hits, strict=True)]
            if any(reached) and not any(hits):
                missing.append(name)
        return counts[0] if len(set(counts)) == 1 else 0, tuple(missing)

    def _solutions_at(
        self, inverse: InverseKinematics, places: Sequence[Place]
    ) -> Iterator[tuple[str, list[Place | None]]]:
        """Each branch by its name, and its configurations at the poses of some; None where it does not exist."""
        robot, joints = self._model.robot, self._model.robot.joints
        symbols = (*geometry_symbols(robot), *self.given)
        values = {sympy.Symbol(name): np.array([place.values[name] for place in places]) for name in symbols}
        for i, j in product(range(3), range(4)):
            values[inverse.pose[i, j]] = np.array([place.pose[i][j] for place in places])
        for solution in inverse.solutions:
            # the lines of a branch one after the other, as arrays (places,); NaN where the branch does not exist
            known = with_lines(values, solution.lines)
            own = {j.variable: np.broadcast_to(known[sympy.Symbol(j.variable)], len(places)) for j in joints}
            angles = ({n: float(q[k]) for n, q in own.items()} for k in range(len(places)))
            pairs = zip(places, angles, strict=True)
            met = (self._printed.moved(place, q) if all(map(math.isfinite, q.values())) else None for place, q in pairs)
            yield solution.name, list(met)
