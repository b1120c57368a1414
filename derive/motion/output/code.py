"""A motion as generated code: ``motion.h`` and ``motion.c`` in C99, ``motion_casadi.py``; all verified.

    NAME_motion(t, q, qd, qdd)          C
    q, qd, qdd = motion(t)              CasADi, differentiable

Both are made of the same tapes, one for each kind of piece, and of one table of pieces, whose rows begin with start and
duration; then come the values at the ends. A polynomial is the sum of its values by the basis of
`derive.plans.profile`, so that nothing is rounded at its ends in any language.
"""

import ctypes
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property, reduce
from math import factorial
from operator import add, mul

import numpy as np
import sympy

from derive.algebra import constants
from derive.arrays import Array
from derive.errors import QuantityError, VerificationError
from derive.interrupts import TemporaryFolder
from derive.lecture.sympy_conversion import expression_from_sympy
from derive.motion.motion import Motion
from derive.plans.profile import TIME, AnyPiece, Cosine, Piece, basis
from derive.programs.program import joint_lines
from derive.programs.tape.build import cut
from derive.programs.tape.derivative import derivative
from derive.programs.tape.graph import ONE, Graph
from derive.programs.tape.tape import LEAVES, Op, Tape
from derive.programs.tape.value import Value
from derive.publish.modules import module_of
from derive.targets import casadi
from derive.targets.compiler import Command, compile_shared, find_compiler
from derive.targets.escape import c_comment, c_prefix, python_docstring, python_string
from derive.targets.kernel import PYTHON, C, CodePiece, Language, wrapped, write_statements
from derive.targets.templating import render
from derive.verification.generated import C_OPTIONS
from derive.verification.tolerance import FLOOR, TINY, TOLERANCE, relative_errors
from derive.verification.verify import REMEDY
from derive.version import __version__

CLOCK, ROW = "t", "row"  # arguments of a tape: the time [s], and the numbers of a piece
NAMES = {2: "cubic", 3: "quintic", 4: "septic"}  # polynomials by the number of values at each end
HARMONIC = "harmonic"

_FUNCTIONS: dict[type[sympy.Expr], Callable[..., Value]] = {
    sympy.Add: lambda *terms: reduce(add, terms),
    sympy.Mul: lambda *factors: reduce(mul, factors),
    sympy.sin: Value.sin,
    sympy.cos: Value.cos,
    sympy.tan: lambda angle: angle.sin() / angle.cos(),
    sympy.sign: Value.sign,
    sympy.Abs: abs,
    sympy.atan2: Value.arctangent,
}


@dataclass(frozen=True, slots=True)
class Kernel:
    """How one kind of piece is computed."""

    name: str  # for instance ``quintic``, or ``curve_q1``
    tape: Tape  # its outputs are position, velocity and acceleration

    def written(self, language: Language) -> tuple[tuple[str, ...], tuple[str, ...]]:
        """Its statements and results, with ``t``, ``row[0]``, ... for the arguments."""
        texts: dict[int, CodePiece] = {}
        for i, node in enumerate(self.tape.nodes):
            if node.op is Op.CONSTANT:
                texts[i] = language.number(node.value)
            elif node.source is not None:
                kind = node.source.kind
                texts[i] = CodePiece(CLOCK if kind == CLOCK else f"{kind}[{node.source.index}]")
        operations = [i for i, node in enumerate(self.tape.nodes) if node.op not in LEAVES]
        statements = write_statements(self.tape, language, operations, texts)
        return statements, tuple(language.output(self.tape, output, texts) for output in self.tape.outputs)

    @property
    def unused(self) -> tuple[str, ...]:
        """Arguments that its tape does not ask for."""
        read = {node.source.kind for node in self.tape.nodes if node.source is not None}
        return tuple(name for name in (CLOCK, ROW) if name not in read)


def kernel_name(piece: AnyPiece, joint: str) -> str:
    """The kernel of a piece."""
    if isinstance(piece, Piece):
        return NAMES[piece.k]
    return HARMONIC if isinstance(piece, Cosine) else f"curve_{joint}"


def kernel_of(piece: AnyPiece, joint: str) -> Kernel:
    """How a piece is computed, and all others of its kind."""
    graph = Graph()
    if isinstance(piece, Piece | Cosine):
        start, duration = (Value(graph, graph.input(ROW, i)) for i in range(2))
        u = (Value(graph, graph.input(CLOCK, 0)) - start) / duration
        outputs = _hermite(graph, piece.k, u, duration) if isinstance(piece, Piece) else _harmonic(graph, u, duration)
    else:
        clock, one = Value(graph, graph.input(CLOCK, 0)), Value(graph, ONE)
        q = _value(graph, piece.formulas[0], clock)
        (qd,) = derivative([q], {clock: one})
        outputs = [q, qd, *derivative([qd], {clock: one})]
    return Kernel(kernel_name(piece, joint), cut(graph, [output.ref for output in outputs]))


def row_of(piece: AnyPiece) -> tuple[float, ...]:
    """The numbers of a piece as its kernel takes them."""
    values = piece.values if isinstance(piece, Piece | Cosine) else ()
    return tuple(map(float, (piece.start, piece.duration, *(value for end in values for value in end))))


def _end(graph: Graph, place: int) -> Value:
    return Value(graph, graph.input(ROW, place + 2))


def _hermite(graph: Graph, k: int, u: Value, duration: Value) -> list[Value]:
    """The polynomial with k values at each end, and its derivatives, in which positions count by their difference."""
    weights = [_end(graph, b) * duration ** (b % k) * Fraction(1, factorial(b % k)) for b in range(2 * k)]
    zero = Value(graph, graph.number(Fraction(0)))
    outputs = []
    for order in range(3):
        total = zero
        for row, weight in zip(basis(k), weights, strict=True):
            for _ in range(order):
                row = tuple(power * coefficient for power, coefficient in enumerate(row))[1:]
            total = total + reduce(lambda value, c: value * u + c, reversed(row), 0 * u) * weight  # Horner's rule
        outputs.append(total / duration**order)
        weights[0], weights[k] = zero, _end(graph, k) - _end(graph, 0)
    return outputs


def _harmonic(graph: Graph, u: Value, duration: Value) -> list[Value]:
    """A harmonic piece, symmetric about its middle as `derive.motion.curves.trajectory` has it."""
    pi = Value(graph, graph.number(constants.pi()))
    q0, q1 = _end(graph, 0), _end(graph, 1)
    way = q1 - q0
    late = Value(graph, graph.number(Fraction(1, 2))).less(u)
    angle = pi * late.select(1 - u, u)
    wave = late.select(-angle.cos(), angle.cos())
    rate = pi / duration
    q = late.select(q1 - way * (1 + wave) / 2, q0 + way * (1 - wave) / 2)
    return [q, way * rate * angle.sin() / 2, way * rate**2 * wave / 2]


def _value(graph: Graph, formula: sympy.Expr, clock: Value) -> Value:
    """A formula of the grammar of cells as a value."""
    if formula == TIME:
        return clock
    if not formula.has(TIME):
        number = Fraction(float(formula)) if formula.has(sympy.Float) else None
        exact = constants.exact_number(expression_from_sympy(formula), {}) if number is None else number
        return Value(graph, graph.number(exact))
    if isinstance(formula, sympy.Pow) and formula.exp.is_Rational and formula.exp.q <= 2:
        base = _value(graph, formula.base, clock)
        return (base if formula.exp.q == 1 else base.sqrt()) ** int(formula.exp.p)
    if formula.func not in _FUNCTIONS:
        found = f"{formula} has no place in generated code"
        raise QuantityError(found, allowed="allowed: sin, cos, tan, sqrt, atan2, sign")
    return _FUNCTIONS[formula.func](*(_value(graph, argument, clock) for argument in formula.args))


FILES = HEADER, CODE, MODULE = "motion.h", "motion.c", "motion_casadi.py"

TIMES = 200  # random times at which generated code is compared with Python, beside all at which a piece begins or ends
LONG = 2000  # pieces from which on CasADi looks them up in a table, on MX, instead of choosing among them on SX
MOST = 100_000  # most pieces; the code of more has tens of megabytes
# Functions of <math.h>: one time is no batch for which branches would be too dear.
_OF_MATH = {Op.ARCTANGENT: "atan2", Op.ABSOLUTE: "fabs", Op.MAXIMUM: "fmax", Op.MINIMUM: "fmin"}
_C = replace(C, names={**C.names, **_OF_MATH})
_CASADI = replace(PYTHON, names={op: f"casadi.{name}" for op, name in casadi.NAMES.items()})


@dataclass(frozen=True, slots=True)
class VerifiedCode:
    """The files, and how far their values are from Python's."""

    files: Mapping[str, bytes]  # contents by name
    worst: float  # largest relative error of position, velocity and acceleration
    left_out: tuple[str, ...]  # files that were not verified since there is no C compiler


def verified_code(motion: Motion, name: str | None = None) -> VerifiedCode:
    """Generate the code of a motion and verify it; C has the name before ``_motion``, that of the robot for None."""
    code = MotionCode(motion, c_prefix(name or motion.plan.robot.name))
    texts, compiler = code.texts, find_compiler()
    worst = verify_code(motion, texts, code.prefix, compiler)
    return VerifiedCode({file: text.encode() for file, text in texts.items()}, worst, () if compiler else (CODE,))


@dataclass(frozen=True)
class MotionCode:
    """The code of a motion."""

    motion: Motion
    prefix: str  # how its names begin in C

    @cached_property
    def texts(self) -> dict[str, str]:
        """All files by name."""
        context = self._context
        return {
            HEADER: render("motion/motion.h.jinja", **context),
            CODE: render("motion/motion.c.jinja", **context | self._kernel_texts(_C)),
            MODULE: render("motion/motion_casadi.py.jinja", **context | self._kernel_texts(_CASADI)),
        }

    @cached_property
    def _pieces(self) -> tuple[tuple[str, tuple[AnyPiece, ...]], ...]:
        segments, joints = self.motion.trajectory.segments, self.motion.plan.robot.variables
        if (count := sum(len(pieces) for segment in segments for pieces in segment.joints)) > MOST:
            remedy = "record fewer rows, or fewer lines and arcs in space"
            raise QuantityError(f"a motion of {count} pieces", allowed=f"allowed in code: {MOST}", remedy=remedy)
        tracks = (tuple(piece for segment in segments for piece in segment.joints[j]) for j in range(len(joints)))
        return tuple(zip((joint.variable for joint in joints), tracks, strict=True))

    @cached_property
    def _kernels(self) -> dict[str, Kernel]:
        kinds = {kernel_name(piece, joint): (piece, joint) for joint, pieces in self._pieces for piece in pieces}
        return {name: kernel_of(piece, joint) for name, (piece, joint) in kinds.items()}

    def _kernel_texts(self, language: Language) -> dict[str, object]:
        found = []
        for place, kernel in enumerate(self._kernels.values()):
            body, results = kernel.written(language)
            assignments = [f"result[{i}] = {text};" for i, text in enumerate(results)]
            texts = {"body": body, "results": results, "assignments": assignments, "unused": kernel.unused}
            found.append({"name": kernel.name, "place": place, **texts})
        return {"kernels": found}

    @property
    def _context(self) -> dict[str, object]:
        motion, plan = self.motion, self.motion.plan
        places = {name: place for place, name in enumerate(self._kernels)}
        joints = []
        # Pieces as texts: places of their kernels in lines, their numbers, and both in pairs of Python.
        for variable, pieces in self._pieces:
            kinds = [str(places[kernel_name(piece, variable)]) for piece in pieces]
            rows = [", ".join(map(repr, row_of(piece))) for piece in pieces]
            pairs = [f"({kind}, ({row}))" for kind, row in zip(kinds, rows, strict=True)]
            joints.append({"variable": c_comment(variable), "kinds": wrapped(kinds), "rows": rows, "pairs": pairs})
        counts = np.cumsum([0, *(len(pieces) for _, pieces in self._pieces)])
        spans = [(s.name, float(s.start), float(s.start + s.duration)) for s in motion.trajectory.segments]
        title = plan.title or f"A motion of {plan.robot.title or plan.robot.name}"
        return {
            "title": c_comment(title),
            "docstring_title": python_docstring(title),
            "version": __version__,
            "digest": plan.digest,
            "joint_lines": joint_lines(plan.robot, c_comment),
            "docstring_joint_lines": joint_lines(plan.robot, python_docstring),
            "joint_names": ", ".join(python_string(joint.label) for joint in plan.robot.variables),
            "segments": [f"{c_comment(name)}: {start:.6g} s to {end:.6g} s" for name, start, end in spans],
            "prefix": self.prefix,
            "guard": f"DERIVE_{self.prefix.upper()}MOTION_H",
            "dof": plan.robot.dof,
            "start": repr(spans[0][1]),
            "end": repr(float(motion.duration)),
            "joints": joints,
            "piece_count": int(counts[-1]),
            "width": max(len(row_of(piece)) for _, pieces in self._pieces for piece in pieces),
            "firsts": ", ".join(map(str, counts.tolist())),
            "has_sign": Op.SIGN in ({node.op for kernel in self._kernels.values() for node in kernel.tape.nodes}),
            "has_base": bool(plan.base),
            "is_long": int(counts[-1]) > LONG,
            "symbol": "MX" if counts[-1] > LONG else "SX",
        }


def verify_code(motion: Motion, texts: Mapping[str, str], prefix: str, compiler: Command | None) -> float:
    """Compare code with the motion at random times, at all ends of pieces, before and after; C needs a compiler."""
    pieces = [piece for segment in motion.trajectory.segments for joint in segment.joints for piece in joint]
    ends = np.unique([float(end) for piece in pieces for end in (piece.start, piece.end)])
    length = float(ends[-1] - ends[0])
    around = [np.nextafter(ends, -np.inf), ends, np.nextafter(ends, np.inf)]
    rest = np.random.default_rng(0).uniform(ends[0], ends[-1], TIMES)
    times: Array = np.concatenate([*around, rest, [ends[0] - length / 2, ends[-1] + length / 2]])
    expected = np.array(motion(times))
    size = np.abs(expected)
    scale = np.maximum(size.max(axis=1, keepdims=True), max(FLOOR * float(size.max()), TINY))
    worst = 0.0
    with TemporaryFolder() as temporary:
        folder = temporary.path
        for name, text in texts.items():
            (folder / name).write_text(text, encoding="utf-8")
        of_casadi = module_of(folder / MODULE, "derive_motion_casadi").motion(times[None, :])
        values = {MODULE: np.array([np.array(value).T for value in of_casadi])}
        if compiler:
            library, n = folder / "motion.so", expected.shape[2]
            compile_shared(compiler, [folder / CODE], library, C_OPTIONS)
            function = getattr(ctypes.CDLL(str(library)), f"{prefix}motion")
            function.argtypes = [ctypes.c_double, *[ctypes.POINTER(ctypes.c_double)] * 3]
            function.restype = None
            values[CODE], row = np.full(expected.shape, np.nan), [(ctypes.c_double * n)() for _ in range(3)]
            for k, t in enumerate(times):
                function(float(t), *row)
                values[CODE][:, k] = row
    for name, got in values.items():
        errors = relative_errors(np.where(got == expected, 0.0, got - expected), scale)
        place = np.unravel_index(int(errors.argmax()), errors.shape)
        if (worst := max(worst, float(errors[place]))) > TOLERANCE:
            what = ("q", "qd", "qdd")[int(place[0])]
            found = f"{what}{place[2] + 1} of {name} is {got[place]!r} instead of {expected[place]!r}"
            raise VerificationError(f"{found} at {times[place[1]]:.17g} s", remedy=REMEDY)
    return worst
