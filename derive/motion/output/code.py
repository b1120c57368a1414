"""A motion as generated code: ``motion.h`` and ``motion.c`` in C99, ``motion_casadi.py``; all verified.

    NAME_motion(t, q, qd, qdd)          C
    q, qd, qdd = motion(t)              CasADi, differentiable

Both are made of the same tapes, one for each kind of piece (`kernels`), and of one table of pieces.
"""

import ctypes
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from derive.arrays import Array
from derive.errors import QuantityError, VerificationError
from derive.interrupts import TemporaryFolder
from derive.motion.motion import Motion
from derive.motion.output.kernels import C_NAMES, Kernel, kernel_name, kernel_of, row_of, with_names
from derive.motion.torques.functions import module_of
from derive.plans.profile import AnyPiece
from derive.programs.program import joint_lines
from derive.programs.tape.tape import BRANCHING_NAMES, FUNCTION_NAMES, Op
from derive.targets.compiler import Command, compile_shared, find_compiler
from derive.targets.escape import c_comment, c_prefix, python_docstring, python_string
from derive.targets.kernel import PYTHON, C, Language, wrapped
from derive.targets.templating import render
from derive.verification.c_model import C_OPTIONS
from derive.verification.tolerance import FLOOR, TINY, TOLERANCE, relative_errors
from derive.verification.verify import REMEDY
from derive.version import __version__

FILES = HEADER, CODE, MODULE = "motion.h", "motion.c", "motion_casadi.py"

TIMES = 200  # random times at which generated code is compared with Python, beside all at which a piece begins or ends
LONG = 2000  # pieces from which on CasADi looks them up in a table, on MX, instead of choosing among them on SX
MOST = 100_000  # most pieces; the code of more has tens of megabytes
_C = with_names(C, C_NAMES)

_CASADI_NAMES = {op: f"casadi.{name}" for op, name in {**FUNCTION_NAMES, **BRANCHING_NAMES}.items()} | {
    Op.LESS: "casadi.lt",
    Op.SELECT: "casadi.if_else",
    Op.MAXIMUM: "casadi.fmax",
    Op.MINIMUM: "casadi.fmin",
    Op.ABSOLUTE: "casadi.fabs",
}
_CASADI = with_names(PYTHON, _CASADI_NAMES)


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
        segments, joints = self.motion.trajectory.segments, self.motion.plan.robot.joints
        count = sum(len(pieces) for segment in segments for pieces in segment.joints)
        if count > MOST:
            remedy = "record fewer rows, or fewer lines and arcs in space"
            raise QuantityError(f"a motion of {count} pieces", allowed=f"allowed in code: {MOST}", remedy=remedy)
        return tuple(
            (joint.variable, tuple(piece for segment in segments for piece in segment.joints[j]))
            for j, joint in enumerate(joints)
        )

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
        title = plan.title or f"A motion of {plan.robot.title or plan.robot.name}"
        operations = {node.op for kernel in self._kernels.values() for node in kernel.tape.nodes}
        return {
            "title": c_comment(title),
            "docstring_title": python_docstring(title),
            "version": __version__,
            "digest": plan.digest,
            "joint_lines": joint_lines(plan.robot, c_comment),
            "docstring_joint_lines": joint_lines(plan.robot, python_docstring),
            "joint_names": ", ".join(python_string(joint.label) for joint in plan.robot.joints),
            "segments": tuple(
                f"{c_comment(segment.name)}: {float(segment.start):.6g} s to "
                f"{float(segment.start + segment.duration):.6g} s"
                for segment in motion.trajectory.segments
            ),
            "prefix": self.prefix,
            "guard": f"DERIVE_{self.prefix.upper()}MOTION_H",
            "dof": plan.robot.n,
            "start": repr(float(motion.trajectory.segments[0].start)),
            "end": repr(float(motion.duration)),
            "joints": joints,
            "piece_count": int(counts[-1]),
            "width": max(len(row_of(piece)) for _, pieces in self._pieces for piece in pieces),
            "firsts": ", ".join(map(str, counts.tolist())),
            "has_sign": Op.SIGN in operations,
            "has_base": plan.base is not None,
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
            values[CODE] = _c_values(folder, prefix, compiler, times, expected.shape[2])
    for name, got in values.items():
        errors = relative_errors(np.where(got == expected, 0.0, got - expected), scale)
        place = np.unravel_index(int(errors.argmax()), errors.shape)
        worst = max(worst, float(errors[place]))
        if worst > TOLERANCE:
            what = ("q", "qd", "qdd")[int(place[0])]
            found = f"{what}{place[2] + 1} of {name} is {got[place]!r} instead of {expected[place]!r}"
            raise VerificationError(f"{found} at {times[place[1]]:.17g} s", remedy=REMEDY)
    return worst


def _c_values(folder: Path, prefix: str, compiler: Command, times: Array, n: int) -> Array:
    """q, qd, qdd of the compiled function, (3, times, n)."""
    library = folder / "motion.so"
    compile_shared(compiler, [folder / CODE], library, C_OPTIONS)
    function = getattr(ctypes.CDLL(str(library)), f"{prefix}motion")
    function.argtypes = [ctypes.c_double, *[ctypes.POINTER(ctypes.c_double)] * 3]
    function.restype = None
    found = np.full((3, times.size, n), np.nan)
    row = [(ctypes.c_double * n)() for _ in range(3)]
    for k, t in enumerate(times):
        function(float(t), *row)
        found[:, k] = row
    return found
