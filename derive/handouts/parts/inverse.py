"""The part with the inverse kinematics: from the pose of the end effector to every configuration that reaches it."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import cached_property

import sympy

from derive.handouts.layout.lines import Equation, equated, equation_lines, matrix
from derive.handouts.notation.pieces import joined
from derive.handouts.notation.symbols import bold
from derive.handouts.parts.inverse_example import example
from derive.handouts.parts.inverse_words import WIDEST_LEFT, FormulaWriter, and_list, branch_name, sources, words_alone
from derive.handouts.sheet.context import Context
from derive.handouts.sheet.document import Block, Paragraph, Rows, SheetFormula, Table
from derive.inverse.closed.nodes import NodeKind
from derive.inverse.closed.solve import MAX_JOINTS, Freedom, solve, usual_task
from derive.inverse.words.derivation import OriginForm, PrintedStep
from derive.inverse.words.elementary import PrintedLine
from derive.inverse.words.solutions import InverseKinematics
from derive.model.model import Model
from derive.model.singularities.aspects import coincidences
from derive.model.singularities.singularities import Posture, SingularFactor
from derive.robot.expression import ZERO
from derive.robot.options.inverse import POSE, InverseOptions

LONGEST_SUM = 80.0  # lines of formulas on paper beyond which the part leaves them to the generated code
MOST_TERMS = 200  # of all equations of an arm; longer ones are not even written, which takes longer than a sheet should
MOST_BRANCHES = 16  # in the table of branches
Factors = Sequence[SingularFactor]  # of det J


def inverse(context: Context) -> Iterator[Block]:
    """How the joint variables follow from the pose."""
    if context.robot.root:
        yield context.paragraph("The root moves, and a pose of an end alone does not determine the joint variables.")
        return
    task = usual_task(context.robot)
    equations = (equation for node in solve(context.robot, task).nodes for equation in node.formulas[0].equations)
    if sum(len(p) for equation in equations for p in equation.terms.values()) > MOST_TERMS:
        yield _too_long(context)
        return
    found = context.entries.model.inverse
    if task != found.graph.task:
        found = Model(replace(context.robot, inverse=InverseOptions(task))).inverse
    part = InversePart(context, found)
    if context.places != tuple(range(context.robot.n)):
        yield context.paragraph(
            "Joints, axes and frames are counted along this arm from 1: they are joints %(joints)s of the tree.",
            joints=", ".join(f"${place + 1}$" for place in context.places),
        )
    yield from part.given()
    if not found.graph.is_closed:
        yield part.why_not()
        return
    yield from part.counted()
    yield from part.decoupled()
    yield from part.derived()
    if task != context.entries.model.inverse.graph.task:
        whole = InversePart(context, context.entries.model.inverse)
        yield context.paragraph(
            "If the orientation is also given, the arm has fewer joints than the pose has coordinates, and fewer "
            "solutions remain."
        )
        yield from whole.conditions()
        yield whole.number_of_solutions()
    yield from part.branches()
    if context.robot.n > 1:
        yield from example(context, found)


def _too_long(context: Context) -> Paragraph:
    _ = context.text
    words = _("The formulas of this arm are too long to print; `inverse_kinematics` in `model_numpy.py` computes them.")
    if context.whole.robot.is_tree:
        words = _("The formulas of this arm are too long to print.")
    return Paragraph(words, is_answer=True)


class InversePart:
    """One arm's inverse kinematics on its way to the page."""

    def __init__(self, context: Context, found: InverseKinematics) -> None:
        self.context, self.found = context, found
        writer = self.writer = FormulaWriter(context, found)
        self._tex, self._math, self._pieces = writer.tex, writer.math, writer.printer.pieces

    def given(self) -> Iterator[Block]:
        """What is known, and what is looked for."""
        pose, task = self.found.pose, self.found.graph.task
        if task == POSE:
            yield self.context.paragraph(
                "Given the pose $%(end)s$ of the end effector in the world frame, find all values of the joint "
                "variables that reach it. The entries of the pose are written",
                end=self.context.symbols.of_end("T").tex,
            )
            cells = [[joined(self._pieces(entry)) for entry in row] for row in pose.tolist()]
            yield Rows((equated(self.context.symbols.of_end("T"), matrix(cells)).tex,))
        else:
            yield self.context.paragraph(
                "Given the entries %(entries)s of the pose $%(end)s$ of the end effector, find all values of the "
                "joint variables that reach them.",
                end=self.context.symbols.of_end("T").tex,
                entries=and_list(self.context.text, [self._math(pose[i, j]) for i, j in self.found.graph.places]),
            )

    def why_not(self) -> Paragraph:
        """Why there are no formulas, and what is done instead."""
        _, n = self.context.text, self.context.robot.n
        if n > MAX_JOINTS:
            reason = _("Of an arm with %(n)s joints no closed form is derived.", n=n)
        else:
            reason = _(
                "The joints cannot be solved one after the other: in no order does each follow from the pose and "
                "the joints before it."
            )
        rest = _(
            "Its configurations are computed in numbers: Newton's method with the Jacobian, its steps damped near "
            "singularities, from many configurations."
        )
        return Paragraph(reason if self.context.whole.robot.is_tree else f"{reason} {rest}")

    def counted(self) -> Iterator[Block]:
        """Redundancy, the conditions on the pose, the number of solutions, and the three cases."""
        found = self.found
        if given := [self._math(step.unknown) for step in found.steps if step.kind is NodeKind.GIVEN]:
            yield self.context.paragraph(
                "With %(n)s joints for %(m)s coordinates the arm is redundant of degree $R = N - M = %(r)s$, and "
                "a pose has infinitely many solutions. Besides the pose these joint variables are given: "
                "%(given)s.",
                n=self.context.robot.n,
                m=self.context.robot.n - len(given),
                r=len(given),
                given=and_list(self.context.text, given),
            )
        yield from self.conditions()
        yield self.number_of_solutions()
        if found.count > 1 and found.is_explicit:
            yield self.context.answer(
                "Three cases can occur: finitely many solutions; none, where a root is not real, for the pose lies "
                "outside the workspace; infinitely many, where a joint below is free."
            )

    def conditions(self) -> Iterator[Block]:
        """What a pose must satisfy to be reached by an arm with few joints."""
        _, conditions = self.context.text, self.found.conditions
        if not conditions:
            return
        yield self.context.answer("With %(n)s joints the arm reaches a pose only if:", n=self.context.robot.n)
        within = {line.symbol: line.value for line in self.found.definitions}
        sides = [(self._pieces(c.left.xreplace(within)), c.right.xreplace(within)) for c in conditions]
        short = [(left, right) for left, right in sides if joined(left).width < WIDEST_LEFT]
        lines = equation_lines(Equation(joined(left), tuple(self._pieces(right))) for left, right in short)
        lines += [line for side in sides if side not in short for line in self.writer.broken(*side)]
        task = _("Which conditions must a pose satisfy so that the arm can reach it?")
        yield SheetFormula((Rows(tuple(lines)),), task=task, blanks=("",))
        variables = {self._variable(k) for k in range(self.context.robot.n)}
        if any(not variables.isdisjoint(map(str, e.free_symbols)) for c in conditions for e in (c.left, c.right)):
            yield self.context.answer("with the joint variables of the solution.")

    def number_of_solutions(self) -> Paragraph:
        """How many solutions a pose has that is reached at all."""
        _, found, answer = self.context.text, self.found, self.context.answer
        if not found.complete:
            return answer("A reachable pose has at most %(leaves)s solutions.", leaves=found.graph.leaves)
        if not found.everywhere:
            return answer(
                "Solutions, real or complex, of almost all reachable poses: %(count)s. Special poses may have more.",
                count=found.count,
            )
        if found.count == 1:
            return answer("A reachable pose has exactly one solution.")
        words = _(
            "A reachable pose has %(count)s solutions, real or complex; the list below is complete.",
            count=found.count,
        )
        if found.is_explicit and found.graph.leaves > found.count:
            words += " " + _(
                "Of the %(leaves)s choices of signs some miss the pose; putting them into $%(end)s$ tells which.",
                leaves=found.graph.leaves,
                end=self.context.symbols.of_end("T").tex,
            )
        return Paragraph(words, is_answer=True)

    def decoupled(self) -> Iterator[Block]:
        """How the problem falls into parts, and names for what the pose is within the arm."""
        _, found, n = self.context.text, self.found, self.context.robot.n
        if wrist := self._is_decoupled:
            yield self.context.paragraph(
                "Axes 4, 5 and 6 meet in the wrist centre, which joints 4, 5 and 6 do not move. So the problem "
                "decouples: the position of the wrist centre follows from the pose and gives joints 1, 2 and 3; "
                "the orientation that is left gives joints 4, 5 and 6."
            )
        for total, name in found.sums.items():
            axes = and_list(_, [str(k + 1) for k in range(n) if sympy.Symbol(self._variable(k)) in total.free_symbols])
            named = f"${self._tex(name)} = {self._tex(total)}$"
            yield self.context.paragraph(
                "Axes %(axes)s are parallel; %(sum)s is found as an unknown of its own.", axes=axes, sum=named
            )
        if not found.definitions:
            if wrist:
                yield Paragraph(_("Here the wrist centre is the origin $%(p)s$ of the end effector.", p=bold("p").tex))
            return
        if found.is_point:
            words, task = _("The line along both planes:"), _("Find the line along both planes.")
        elif wrist and len({line.symbol for line in found.definitions}) <= 3:
            words, task = _("The wrist centre:"), _("Find the wrist centre from the pose.")
            if found.robot.joints[0].d != ZERO:
                words = _("Wrist centre relative to frame 0, moved by the constant offset of joint 1:")
        else:
            words = _("Without base, tool and what is constant at both ends of the arm the pose is:")
            task = _("Take base, tool and what is constant at both ends of the arm off the pose.")
        yield Paragraph(words)
        yield self.writer.formula(found.definitions, task, is_each_asked=True)

    @cached_property
    def _is_decoupled(self) -> bool:
        """Whether joints 1 to 3 follow from the position of the wrist centre."""
        robot, order = self.context.robot, [step.joints for step in self.found.steps if len(step.joints) == 1]
        if robot.n != 6 or self.found.graph.task != POSE:
            return False
        last = [k for joints in order for k in joints].index
        wrist = [last(k) for k in (3, 4, 5)]
        arm = [min(k for k, s in enumerate(self.found.steps) if j in s.joints) for j in (0, 1, 2)]
        return min(wrist) >= 2 and max(arm) < len(self.found.steps) and Freedom(robot, POSE).meet(3)

    def _variable(self, joint: int) -> str:
        return self.context.robot.joints[joint].variable

    def derived(self) -> Iterator[Block]:
        """Each unknown in its order."""
        found = self.found
        if sum(len(self.writer.rows(line)) for step in found.steps for line in step.lines) > LONGEST_SUM:
            yield _too_long(self.context)
            return
        # Singularities are those of one chain; an arm of the unknown joints of a loop is none.
        is_chain = not (self.context.robot.is_tree or self.context.whole.robot.loops)
        factors = self.context.entries.model.singularities.factors if is_chain else ()
        for step, (merged, free) in zip(found.steps, coincidences(found, factors), strict=True):
            if step.kind not in (NodeKind.GIVEN, NodeKind.GENERAL):
                yield from self._step(step, merged, free)
        if (node := next((node for node in found.graph.nodes if node.kind is NodeKind.GENERAL), None)) is None:
            return
        hidden, others, eliminated = node.formulas[0].payload.joints

        def _names(*joints: int) -> str:
            symbols = (self.context.notation.glyph(self._variable(k)).box.tex.strip() for k in sorted(joints))
            return and_list(self.context.text, [f"${symbol}$" for symbol in symbols])

        yield self.context.answer(
            "No joint follows from the pose by itself. Equations between %(between)s that hold whatever %(without)s "
            "are form an eigenvalue problem of a matrix with %(size)s rows: its eigenvalues give %(hidden)s, its "
            "eigenvectors %(others)s, and linear equations then %(without)s.",
            between=_names(hidden, *others),
            without=_names(*eliminated),
            hidden=_names(hidden),
            others=_names(*others),
            size=node.formulas[0].payload.solution.eliminations[0].eigenvalues,
        )

    def _step(self, step: PrintedStep, merged: Factors, free: Factors) -> Iterator[Block]:
        _, unknown = self.context.text, self._math(step.unknown)
        if step.kind is NodeKind.SUM:
            words = _("%(unknown)s follows from the angles already found:", unknown=unknown)
        else:
            source, equation = sources(self.context, step.equations), step.equations[0]
            # What the sides of a triangle make of the cosine of one of its angles.
            squared = any(origin.form in (OriginForm.SQUARES, OriginForm.DISTANCE) for origin in equation.origins)
            is_alone = len(step.equations) == len(step.joints) == len(equation.left.atoms(sympy.cos, sympy.sin)) == 1
            if squared and is_alone and equation.left.is_Mul:
                source = _("%(source)s: the law of cosines", source=source)
            words = f"{unknown}: {source}."
        yield Paragraph(words, is_answer=True)
        if equations := [e for e in step.equations if PrintedLine(e.left, e.right) not in step.lines]:
            lines = [line for e in equations for line in self.writer.broken(self._pieces(e.left), e.right)]
            yield Rows(tuple(lines), is_answer=True)
        if step.lines:
            yield self.writer.formula(step.lines, _("Solve the inverse kinematics for %(unknown)s.", unknown=unknown))
        if remarks := " ".join(self._remarks(step, merged, free)):
            yield Paragraph(remarks, is_answer=True)

    def _remarks(self, step: PrintedStep, merged: Factors, free: Factors) -> Iterator[str]:
        """When a step has real values, where they are one, and where it has infinitely many."""
        _, unknown = self.context.text, self._math(step.unknown)
        if step.kind is NodeKind.CONIC:
            yield _(
                "In $\\tan(%(unknown)s/2)$ this is an equation of the fourth degree: up to four values of %(symbol)s.",
                unknown=self._tex(step.unknown),
                symbol=unknown,
            )
        if step.exists is not sympy.true:
            # |D| <= 1, or A^2 + B^2 >= K^2
            left, right = step.exists.lhs, self._tex(step.exists.rhs)
            shown = f"\\lvert {self._tex(left.args[0])} \\rvert" if isinstance(left, sympy.Abs) else self._tex(left)
            sign = "\\leq" if step.exists.rel_op == "<=" else "\\geq"
            yield _(
                "Real if %(condition)s; at equality (workspace boundary) the two solutions coincide.",
                condition=f"${shown} {sign} {right}$",
            )
            if merged:
                yield _("This happens at a singularity of the arm: %(factors)s.", factors=self._zeros(merged))
        if not step.fails:
            return
        where = and_list(_, [f"${self._tex(e)} = 0$" for e in step.fails])
        if step.instead:
            yield _(
                "Where %(zeros)s, it follows from %(equations)s instead (%(source)s).",
                zeros=where,
                equations=and_list(_, [f"${self._tex(e.left)} = {self._tex(e.right)}$" for e in step.instead[0]]),
                source=sources(self.context, step.instead[0]),
            )
            return
        if self.found.is_point:
            yield _("Where %(zeros)s, this does not determine %(unknown)s.", zeros=where, unknown=unknown)
            return
        yield _(
            "Where %(zeros)s, %(unknown)s is free: there are infinitely many solutions.", zeros=where, unknown=unknown
        )
        if free:
            yield _("The arm is singular there: %(factors)s.", factors=self._zeros(free))

    def _zeros(self, factors: Sequence[SingularFactor]) -> str:
        """``$s_5 = 0$ (wrist)``, factors of det J."""
        _ = self.context.text
        words = {Posture.WRIST: _("wrist"), Posture.ELBOW: _("elbow"), Posture.SHOULDER: _("shoulder")}
        found = []
        for factor in factors:
            posture = words.get(factor.condition.posture) if factor.condition and factor.condition.posture else None
            zero = f"${self.context.printer.latex(factor.expression)} = 0$"
            found.append(f"{zero} ({posture})" if posture else zero)
        return and_list(_, found, either=True)

    def branches(self) -> Iterator[Block]:
        """Which signs lead to which posture."""
        _, solutions = self.context.text, self.found.solutions
        if not 1 < len(solutions) <= MOST_BRANCHES:
            return
        columns = {sign: step.unknown for step in self.found.steps for line in step.lines for sign in line.signs}
        notation = self.writer.printer.notation
        postures = [branch_name(_, notation, words_alone(solution.name)) for solution in solutions]
        signs = [[f"${'+' if solution.signs[sign] > 0 else '-'}$" for sign in columns] for solution in solutions]
        has_names = any(postures)
        pairs = enumerate(zip(postures, signs, strict=True), 1)
        rows = [(str(number), *([posture] if has_names else []), *own) for number, (posture, own) in pairs]
        words = _("The signs in the formulas of the joints lead to these branches:")
        if any(len(line.alternatives) > 1 for step in self.found.steps for line in step.lines):
            words = _("The signs in the formulas lead to these branches; + denotes the first of two values:")
        yield Paragraph(words, is_answer=True)
        heads = [*([_("Posture")] if has_names else []), *map(self._math, columns.values())]
        yield Table((_("Branch"), *heads), tuple(rows), is_answer=True)
