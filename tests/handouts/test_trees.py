"""Trees on sheets, in figures and on pages: what belongs to which end, formulas as the model's, and all branches."""

import random
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import sympy

from derive.handouts.assemble import OF_ENDS, context_of, document
from derive.handouts.exercise import exercise, solutions
from derive.handouts.figure.scene import Scene, arm_scene
from derive.handouts.sheet.document import Section, SheetFormula, Table, blocks_of
from derive.handouts.sheet.language import languages
from derive.handouts.sheet.latex_writer import latex
from derive.lecture.sympy_conversion import expression_to_sympy
from derive.model.model import Model
from derive.robot import tree
from derive.robot.options.handout import Derivation, HandoutOptions
from derive.robot.robot import Robot
from derive.verification.oracle.functions import Oracle
from derive.workspace.poses import RobotPoses
from tests.handouts.latex_runner import run_clean
from tests.handouts.page.test_browser_viewer import Figure, browser
from tests.handouts.reading import bare_context, lines, words
from tests.random_robots import sampled, seeds
from tests.random_trees import random_tree

assert browser  # a fixture
TREES = ("two-armed-torso", "human-skeleton")
LOOPS = ("four-bar", "slider-crank", "delta")
COUPLED = (*LOOPS, "five-bar", "palletiser", "two-finger-gripper")
PLACE = re.compile(r"_\{(\d+?),?(\d+)\}$")


def sections(robot: Robot, **options: Any) -> dict[str, Section]:
    found = document(context_of(robot, replace(robot.handout, pages=0, **options))).sections
    return {section.anchor: section for section in found}


def printed(section: Section, function: str) -> dict[tuple[int, int], sympy.Expr]:
    """The entries of the formula that a generated function computes, as a reader copies them."""
    formulas = [block for block in blocks_of(section) if isinstance(block, SheetFormula) and block.function == function]
    pairs = ((PLACE.search(entry.name), entry) for formula in formulas[:1] for entry in formula.entries())
    return {(int(at[1]), int(at[2])): sympy.sympify(entry.python) for at, entry in pairs if at}


def assert_same(found: dict[tuple[int, int], sympy.Expr], wanted: Any, *, symmetric: bool = False) -> None:
    at = {symbol: 0.3 + 0.17 * k for k, symbol in enumerate(sorted(wanted.free_symbols, key=str))}
    for (i, j), value in np.ndenumerate(np.array(wanted.subs(at), dtype=float)):
        if not (symmetric and i > j):
            assert float(found.get((i + 1, j + 1), sympy.S.Zero).subs(at)) == pytest.approx(value, abs=1e-12)


@pytest.mark.parametrize("name", TREES)
@pytest.mark.first(1)
def test_formulas_of_every_end_are_those_of_the_model(name: str) -> None:
    robot = Robot.load(name)
    sheet, model = sections(robot), Model(robot)
    ends = [end.name for end in robot.ends]
    assert {f"{part}-{end}" for end in ends for part in OF_ENDS} <= sheet.keys()
    for end in ends:
        assert_same(printed(sheet[f"kinematics-{end}"], f"forward_kinematics_{end}"), model.T[end])
        assert_same(printed(sheet[f"jacobian-{end}"], f"jacobian_{end}"), model.J[end])
        assert ("The root moves" in words(sheet[f"inverse-{end}"])) == (robot.root is not None)


def test_the_dynamics_are_those_of_the_whole_tree() -> None:
    sheet, model = sections(Robot.load(TREES[0])), Model(Robot.load(TREES[0]))
    assert_same(printed(sheet["inertia"], "inertia_matrix"), model.B, symmetric=True)
    entries = bare_context(model.robot).entries
    heads = entries.linear_jacobian(model.n + 1, of_rotor=False), entries.angular_jacobian(model.n + 1, of_rotor=False)
    assert [[(p, e.entry(*p)) for p in e.places if e.terms(*p)] for e in heads] == [[], [((3, 1), 1)]]


@pytest.mark.parametrize("seed", seeds(20, 1, 20))
def test_bodies_add_up_to_the_inertia_matrix(seed: int) -> None:
    robot = random_tree(random.Random(seed), 1 + seed % 3).robot
    context = bare_context(robot)
    model, n = context.entries.model, robot.n
    total = sympy.diag(*(expression_to_sympy(link.armature) for link in robot.links))
    for i in range(1, len(tree.bodies(robot)) + 1):
        for of_rotor in (False, True)[: 1 + (i <= n)]:
            part = context.entries.inertia_part(i, of_rotor)
            total += sympy.Matrix(n, n, lambda r, c, part=part: part.entry(min(r, c) + 1, max(r, c) + 1))
    at = dict.fromkeys(model.q, 0.4)
    assert np.allclose(np.array((total - model.B).subs(at), dtype=float), 0.0, atol=1e-9)


@pytest.mark.parametrize("name", TREES)
@pytest.mark.first(1)
def test_the_table_says_what_each_row_follows(name: str) -> None:
    robot = Robot.load(name)
    sheet = sections(robot)
    assert len(lines(sheet["convention"].blocks)) == 1
    (table,) = (block for block in sheet["table"].blocks if isinstance(block, Table))
    rows = tree.table(robot)
    column, names = (
        table.header.index("after"),
        {row.label: cells[0] for row, cells in zip(rows, table.rows, strict=True)},
    )
    names, before = names | {"": "$0$", "base": "$\\mathrm{base}$"}, tree.antecedents(robot)
    assert [cells[column] for cells in table.rows] == [names[before[row.label]] for row in rows]


@pytest.mark.slow
@pytest.mark.parametrize("seed", seeds(24, 1, 24))
def test_sheets_of_random_trees_are_clean_in_every_language(seed: int, tmp_path: Path) -> None:
    robot = random_tree(random.Random(seed), 1 + seed % 5).robot
    language, derivation = languages()[seed % len(languages())], list(Derivation)[seed % 2]
    context = context_of(robot, replace(robot.handout, language=language, derivation=derivation))
    whole = document(context)
    for sheet in (whole, exercise(whole, context.text), solutions(whole, context.text)):
        run_clean(latex(sheet, context.text), tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize("language", sampled(languages(), ["en"]))
@pytest.mark.parametrize("name", sampled([*TREES, *COUPLED], ["two-armed-torso", "slider-crank"]))
def test_sheets_of_the_catalogue_are_clean(name: str, language: str, tmp_path: Path) -> None:
    context = context_of(Robot.load(name), HandoutOptions(language=language, derivation=Derivation.STEPS))
    run_clean(latex(document(context), context.text), tmp_path)


def joined(scene: Scene) -> int:
    """How many groups of segments hang together."""
    left = [np.stack([segment.start, segment.end]) for segment in scene.segments]
    groups = 0
    while left:
        groups += 1
        group = [left.pop()]
        for own in group:
            near = [k for k, s in enumerate(left) if np.abs(s[:, None] - own).max(axis=-1).min() < 2e-3 * scene.size]
            group += [left.pop(k) for k in reversed(near)]
    return groups


@pytest.mark.parametrize("seed", seeds(60, 4, 60))
def test_every_branch_is_drawn_where_the_oracle_has_it(seed: int) -> None:
    robot = random_tree(random.Random(seed)).robot
    oracle, q = Oracle.of(robot), np.random.default_rng(seed).uniform(-1.0, 1.0, robot.n)
    frames = np.array(RobotPoses(robot).frames(q.tolist()))
    scene = arm_scene(robot, frames.tolist())
    assert np.allclose(frames[1 : robot.n + 1], oracle.evaluate("link_transforms", q), atol=1e-9)
    for end, hand, frame in zip(tree.ends(robot), scene.hands, frames[-len(scene.hands) :], strict=True):
        wanted = oracle.evaluate("_".join(filter(None, ("forward_kinematics", end.name))), q)
        assert np.allclose(frame, wanted, atol=1e-9)
        assert np.allclose(hand.end, wanted[:3, 3], atol=1e-9)
    assert len(scene.joints) == robot.n - (len(robot.root.variables) if robot.root else 0)
    assert joined(scene) <= 1


@pytest.mark.sweep
def test_the_page_moves_all_branches(browser: Any, tmp_path: Path) -> None:
    figure, q = Figure(browser, tmp_path, Robot.load(TREES[1])), np.linspace(0.1, 0.4, 13)
    before, reached = figure.picture(), np.array(figure.set(q))
    oracle = Oracle.of(figure.robot, {str(name): value for name, value in figure.values.items()})
    for k, end in enumerate(figure.robot.ends):
        figure.page.select_option(".viewer-end", str(k))
        assert np.allclose(figure.pose(), oracle.evaluate(f"forward_kinematics_{end.name}", reached), atol=1e-9)
    assert figure.picture() != before
    figure.close()
