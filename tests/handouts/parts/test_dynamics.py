"""The dynamics of the handout: what it prints is true, complete, in the chosen letter, and fits the page."""

import math
import random
import re
from collections.abc import Mapping
from dataclasses import replace
from functools import cache, partial
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from derive.handouts.layout.quantity import SheetPolicy
from derive.handouts.parts.dynamics import bodies
from derive.handouts.sheet.context import Context
from derive.handouts.sheet.document import Rows, Section, SheetFormula, Steps, blocks_of
from derive.handouts.sheet.dynamics import DynamicsLayout
from derive.handouts.sheet.language import Text
from derive.handouts.sheet.latex_writer import latex
from derive.robot.description import Motor
from derive.robot.options.handout import PARTS, HandoutOptions, InertiaLetter
from derive.robot.robot import Robot
from derive.verification.oracle.frames import chain_frames
from derive.verification.oracle.lagrange import kinetic_energy, link_jacobians, potential_energy, rotor_jacobians
from tests.evaluate import evaluate
from tests.handouts.reading import bare_context, changed, document_of, words
from tests.model.test_model_against_oracle import Numbers
from tests.random_robots import catalogue, chains, robot_text, sampled

Array = npt.NDArray[np.float64]

DYNAMICS = PARTS[PARTS.index("link-jacobians") : PARTS.index("example")]
WITH_LINKS = [name for name in chains() if catalogue()[name].has_dynamics]
SHORT = [name for name in WITH_LINKS if catalogue()[name].n <= 7]
SEEDS = range(10)

_FUNCTIONS = {"sin": math.sin, "cos": math.cos, "tan": math.tan, "sqrt": math.sqrt, "pi": math.pi, "sign": np.sign}


def random_arm(seed: int) -> Robot:
    return Robot.from_text(robot_text(random.Random(1000 + seed), 1 + seed % 4))


def part_of(context: Context, part: str, steps: bool = False) -> Section:
    (section,) = document_of(context if steps else changed(context, options=HandoutOptions()), [part]).sections
    return section


def entries_of(section: Section) -> dict[str, str]:
    """Name of every printed entry -> its Python expression."""
    formulas = [block for block in blocks_of(section) if isinstance(block, SheetFormula)]
    return {entry.name: entry.python for block in formulas for entry in block.entries()}


def omitted_of(section: Section) -> str:
    rows = [block for block in blocks_of(section) if isinstance(block, SheetFormula | Rows)]
    return "\n".join(line for b in rows for line in (b.omitted if isinstance(b, SheetFormula) else b.lines))


def value(numbers: Numbers, python: str) -> float:
    return float(eval(python, {"__builtins__": {}}, {**_FUNCTIONS, **numbers.values}))


@cache
def prepared(key: str | int) -> tuple[Context, Numbers]:
    robot = Robot.load(key) if isinstance(key, str) else random_arm(key)
    return bare_context(robot), Numbers(robot, 5)


EVERY = pytest.mark.parametrize("key", sampled([*SHORT, *SEEDS], [*SHORT[::2], *SEEDS[:5]]))


def assert_entries(numbers: Numbers, entries: Mapping[str, str], expected: Mapping[str, float]) -> None:
    scale = max(1.0, *map(abs, expected.values()))
    for name, python in entries.items():
        assert name in expected
        assert value(numbers, python) == pytest.approx(expected[name], abs=1e-9 * scale)


def named(symbol: Any, matrix: Array) -> dict[str, float]:
    n = range(len(matrix))
    return {symbol(i + 1, j + 1): float(matrix[i, j]) for i in n for j in range(matrix.shape[1])}


# -- what is printed is true


@pytest.mark.first(10)
@EVERY
@pytest.mark.parametrize("part", ["inertia", "coriolis", "gravity", "motion"])
def test_entries_are_those_of_the_oracle(key: str | int, part: str) -> None:
    context, numbers = prepared(key)
    symbols, q, qd, qdd = context.symbols, numbers.q, numbers.qd, numbers.qdd
    name, function, arguments = {
        "inertia": (context.dynamics.inertia_entry, "inertia_matrix", (q,)),
        "coriolis": (partial(symbols.entry, "C"), "coriolis_matrix", (q, qd)),
        "gravity": (lambda i, _: symbols.component("g", i), "gravity_vector", (q,)),
        "motion": (lambda i, _: symbols.torque(i), "inverse_dynamics", (q, qd, qdd)),
    }[part]
    matrix = numbers.oracle.evaluate(function, *arguments).reshape(context.robot.n, -1)
    assert_entries(numbers, entries_of(part_of(context, part)), named(lambda i, j: name(i, j).tex, matrix))


@EVERY
def test_bodies_and_armatures_add_up_to_the_inertia_matrix(key: str | int) -> None:
    context, numbers = prepared(key)
    n = range(1, context.robot.n + 1)
    total = np.diag(numbers.oracle.arm.armature.astype(float))
    for body in bodies(context.robot):
        part = context.entries.inertia_part(body.index, body.is_rotor)
        total += np.array([[evaluate(part.entry(i, j), numbers.values) for j in n] for i in n])
    np.testing.assert_allclose(total, numbers.oracle.evaluate("inertia_matrix", numbers.q), rtol=0, atol=1e-9)


@EVERY
def test_jacobians_of_links_and_rotors_are_those_of_the_oracle(key: str | int) -> None:
    context, numbers = prepared(key)
    arm, expected = numbers.oracle.arm, dict[str, float]()
    frames = arm.base @ chain_frames(arm, numbers.q)
    for letter, halves in (("l", link_jacobians(arm, frames)), ("m", rotor_jacobians(arm, frames))):
        for index, half in zip(("v", "\\omega"), halves, strict=True):
            for i, matrix in enumerate(half, 1):
                symbol = f"\\mathbf{{J}}_{{{index}}}^{{{letter}_{{{i}}}}}"
                expected |= named(lambda r, c, symbol=symbol: f"({symbol})_{{{r}{c}}}", matrix)
    assert_entries(numbers, entries_of(part_of(context, "link-jacobians", steps=True)), expected)


@EVERY
def test_energies_are_those_of_the_oracle(key: str | int) -> None:
    context, numbers = prepared(key)
    arm, q = numbers.oracle.arm, numbers.q
    expected = {"T": float(kinetic_energy(arm, q, numbers.qd)), "U": float(potential_energy(arm, q))}
    for name, python in entries_of(part_of(context, "energies")).items():
        letter = name.removeprefix("\\mathcal{").removesuffix("}")
        assert value(numbers, python) == pytest.approx(expected[letter], rel=1e-9, abs=1e-9 if letter == "U" else None)


@EVERY
def test_the_matrix_that_is_printed_as_skew_symmetric_is(key: str | int) -> None:
    context, numbers = prepared(key)
    skewed = entries_of(part_of(context, "skew"))
    for name, python in skewed.items():
        row, column = (int(digit) for digit in re.findall(r"_\{(\d)(\d)\}$", name)[0])
        opposite = skewed.get(context.symbols.entry("N", column, row).tex)
        if opposite is not None:
            assert value(numbers, python) == pytest.approx(-value(numbers, opposite), abs=1e-9)


# -- the Newton-Euler recursion


@EVERY
def test_the_constants_of_the_recursion_are_those_of_the_oracle(key: str | int) -> None:
    """Of link i in its own axes; p leads from o_{i-1} to o_i, in frame i (standard) or frame i-1 (modified)."""
    context, numbers = prepared(key)
    arm, frames = numbers.oracle.arm, chain_frames(numbers.oracle.arm, numbers.q)
    expected: dict[str, float] = {}
    for i in range(1, context.robot.n + 1):
        row = np.linalg.inv(frames[i - 1]) @ frames[i]
        turn, p = row[:3, :3], row[:3, 3]
        for symbol, matrix in ((f"R}}_{{{i}}}^{{{i - 1}}}", turn), (f"I}}_{{{i}}}", arm.inertia[i - 1])):
            expected |= named(lambda r, c, symbol=symbol: f"(\\mathbf{{{symbol})_{{{r}{c}}}", matrix)
        star, p = ("^{*}", turn.T @ p) if arm.standard else ("", p)
        for symbol, vector in ((f"p}}_{{{i}}}{star}", p), (f"r}}_{{c_{{{i}}}}}", arm.com[i - 1])):
            expected |= {f"(\\mathbf{{{symbol})_{{{k}}}": float(x) for k, x in enumerate(vector, 1)}
        expected[f"m_{{{i}}}"] = float(arm.mass[i - 1])
    entries = entries_of(part_of(context, "newton-euler"))
    assert entries.keys() == expected.keys()
    assert_entries(numbers, entries, expected)
    base = [float(evaluate(cell, numbers.values)) for cell in context.entries.base_acceleration]
    assert base == pytest.approx(-arm.gravity_in_frame_0, abs=1e-9)


@pytest.mark.parametrize("name", ["planar-2r-perugia", "scara-perugia"])
def test_every_joint_has_its_own_equations_in_the_steps(name: str) -> None:
    section = part_of(prepared(name)[0], "newton-euler", steps=True)
    steps = [block for block in section.blocks if isinstance(block, Steps)]
    assert len(steps) == 2
    lines = [line for step in steps for rows in step.blocks if isinstance(rows, Rows) for line in rows.lines]
    for i in range(1, Robot.load(name).n + 1):
        assert any(line.startswith(f"\\boldsymbol{{\\omega}}_{{{i}}} = ") for line in lines)
        assert any(line.startswith(f"\\tau _{{{i}}} = ") or line.startswith(f"\\tau_{{{i}}} = ") for line in lines)


# -- nothing is dropped, the chosen letter is used


@EVERY
def test_every_entry_that_is_not_zero_is_printed_or_counted(key: str | int) -> None:
    context, _ = prepared(key)
    n, layout = context.robot.n, DynamicsLayout(context.entries, context.layouter, context.symbols)
    section = part_of(context, "inertia")
    names = {*entries_of(section)}
    left_out = omitted_of(section)
    for i in range(1, n + 1):
        for j in range(i, n + 1):
            name = layout.inertia_entry(i, j).tex  # that above the diagonal
            assert name == layout.inertia_entry(j, i).tex
            if context.entries.B.terms(i, j):
                assert name in names or name in left_out
    symbols = part_of(context, "christoffel")
    names, left_out = {*entries_of(symbols)}, omitted_of(symbols)
    for symbol in (context.symbols.christoffel(*triple).tex for triple in context.entries.triples):
        assert symbol in names or symbol in left_out


@pytest.mark.parametrize("letter", list(InertiaLetter))
def test_the_inertia_matrix_has_the_chosen_letter_everywhere(letter: InertiaLetter) -> None:
    context = bare_context(Robot.load("planar-2r-perugia"), inertia=letter)
    text = latex(document_of(context, DYNAMICS), Text())
    small = letter.value.lower()
    assert f"\\mathbf{{{letter.value}}}(\\mathbf{{q}})" in text
    assert f"\\partial {small}_{{ij}}" in text
    assert f"{small}_{{12}}" in text
    for other in set(InertiaLetter) - {letter}:
        assert f"\\mathbf{{{other.value}}}" not in text
        assert f"{other.value.lower()}_{{12}}" not in text


def test_robots_without_links_have_no_dynamics_and_those_with_many_joints_a_sentence() -> None:
    arm = Robot.from_text("name: arm\ntitle: Arm\nconvention: standard\njoints: [{type: revolute}]\n")
    assert document_of(bare_context(arm), DYNAMICS).sections == ()
    robot = Robot.from_text(robot_text(random.Random(3), 4))
    (section,) = document_of(bare_context(robot, policy=SheetPolicy(closed_form_joints=3)), DYNAMICS).sections
    assert section.part == "inertia"
    assert "not derived" in words(section)


def test_rotors_are_mentioned_where_the_robot_has_them() -> None:
    robot = Robot.load("planar-2r-perugia")
    without = replace(robot, links=tuple(replace(link, motor=None) for link in robot.links))
    assert any(link.motor not in (None, Motor()) for link in robot.links)
    for arm, expected in ((robot, True), (without, False)):
        assert ("rotors" in words(part_of(bare_context(arm), "newton-euler"))) is expected
