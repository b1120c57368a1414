"""Closed forms of trees against the oracle at random points, and as identities; their inverse kinematics."""

import random
from typing import Any

import numpy as np
import pytest

from derive.algebra.domain import PolynomialDomain
from derive.errors import QuantityError
from derive.lecture.sympy_conversion import expression_from_sympy
from derive.model.ends import OfEnds
from derive.model.model import Model
from derive.model.quantity_names import by_ends
from derive.robot import tree
from derive.robot.robot import Robot
from tests.mechanics.test_dynamics import check_identity
from tests.model.test_model_against_oracle import Numbers, check_dynamics, close
from tests.random_robots import configurations, seeds
from tests.random_trees import random_tree
from tests.robot.test_trees import BODY, TORSO, frame


def small(seed: int) -> Robot:
    return random_tree(random.Random(seed), 1 + seed % 4).robot


def check_ends(n: Numbers) -> None:
    kinematics = {"forward_kinematics": n.model.T, "jacobian": n.model.J, "jacobian_end": n.model.J_end}
    for end in tree.ends(n.model.robot):
        suffix = f"_{end.name}" * bool(end.name)
        for function, whole in kinematics.items():
            assert hash(of_end(whole, end.name)), "which what can be changed has not"
            n.check(function + suffix, of_end(whole, end.name))
        n.check(f"jacobian_dot{suffix}", of_end(n.model.J_dot, end.name), n.qd)
        slopes = n.oracle.evaluate(f"jacobian_hessian{suffix}", n.q)
        for k in range(n.model.n):
            close(n.value(of_end(n.model.hessian(k + 1), end.name)), slopes[..., k])


def of_end(quantity: Any, name: str) -> Any:
    return quantity[name] if isinstance(quantity, OfEnds) else quantity


def check_frames(n: Numbers) -> None:
    """Against the products of the rows as the grammar of the file has them."""
    robot, values = n.model.robot, n.values
    known = {row.label: frame(robot, row.label, values) for row in (*robot.joints, *robot.fixed)}
    for label, wanted in known.items():
        close(n.value(n.model.frame(label)), n.oracle.arm.base @ wanted)
        for other, start in known.items():
            close(n.value(n.model.transform(other, label)), np.linalg.solve(start, wanted))


def check_branches(model: Model) -> None:
    """Joints of different branches do not feel each other; Bdot - 2C, in closed form, is skew as a polynomial."""
    ways = [{*tree.path(model.robot, i)} for i in range(model.n)]
    apart = [(i, j) for i in range(model.n) for j in range(model.n) if i not in ways[j] and j not in ways[i]]
    assert [pair for pair in apart if model.B[pair] != 0 or model.C[pair] != 0] == []
    entries = [expression_from_sympy(entry) for entry in model.N]
    domain = PolynomialDomain(model.robot, entries)
    rows = np.array([domain.constant(entry) for entry in entries], dtype=object).reshape(model.n, model.n)
    assert (rows + rows.T == 0).all()


@pytest.mark.parametrize("seed", seeds(100, 2, 40))
def test_closed_forms_of_random_trees_agree_with_the_oracle(seed: int) -> None:
    numbers = Numbers(small(seed), seed)
    check_ends(numbers)
    if numbers.model.robot.is_tree:
        check_frames(numbers)
    if numbers.model.n <= 4:
        check_dynamics(numbers)
        check_branches(numbers.model)


@pytest.mark.parametrize("text", [TORSO, BODY], ids=["torso", "body"])
def test_closed_forms_in_symbols_agree_with_the_oracle_and_are_what_the_recursion_computes(text: str) -> None:
    robot = Robot.from_text(text)
    numbers = Numbers(robot, 3)
    check_ends(numbers)
    check_dynamics(numbers)
    check_branches(numbers.model)
    check_identity(robot)


@pytest.mark.parametrize("seed", seeds(100, 6, 60))
def test_poses_of_ends_come_back_from_inverse_kinematics(seed: int) -> None:
    """Of the ends that stand on arms of up to three joints, mounts, gamma and b between them."""
    robot = small(seed)
    model, q = Model(robot), configurations(random.Random(seed), robot.n)[0]
    for end in tree.ends(robot) if robot.root is None else ():
        arm, places = tree.arm(robot, end.name)
        found = np.array(model.at(f"inverse[{end.name}]" if end.name else "inverse", q.tolist()).tolist(), dtype=float)
        turns = [2 * np.pi if joint.is_revolute else np.inf for joint in arm.joints]
        gaps = found - q[list(places), None]
        gaps -= np.round(gaps / np.array(turns)[:, None]) * np.nan_to_num(turns, posinf=0.0)[:, None]
        assert np.abs(gaps).max(axis=0).min() < 1e-12


ASKED = {
    "T": ["T[left]", "T[right]"],
    "T[]": ["T[left]", "T[right]"],
    "T[][1,4]": ["T[left][1,4]", "T[right][1,4]"],
    "p[3]": ["p[left][3]", "p[right][3]"],
    "hessian[2]": ["hessian[left][2]", "hessian[right][2]"],
    **{name: [name] for name in ("J[left,1,2]", "T[3]", "T[waist, head]", "B[1,2]")},
}
WANTED = {
    "T[ left ][1,4]": lambda m: m.T["left"][0, 3],
    "T[left][]": lambda m: m.T("left"),
    "J[left,1,2]": lambda m: m.J["left"][0, 1],
    "hessian[left,2]": lambda m: m.hessian(2)["left"],
    "hessian[left][2][3,1]": lambda m: m.hessian(2)["left"][2, 0],
    "T[head]": lambda m: m.frame("head"),
    "T[head][1,4]": lambda m: m.frame("head")[0, 3],
    "T[waist,shoulder][2,2]": lambda m: m.transform("waist", "shoulder")[1, 1],
    "T[0,2][1,4]": lambda m: m.transform(0, 2)[0, 3],
    "T[1,6]": lambda m: m.transform("waist", "head"),
    "T[base]": lambda m: m.frame(0),
}
REFUSED = {
    "T[lefft]": "end or row 'lefft' of torso; allowed: left, right, base, waist, .*; did you mean 'left'",
    "T[waist,left]": "row 'left' of torso; allowed: base, waist, ",
    "T[99]": "frame 99 of torso; allowed: 0 to 7",
    "T[,]": "not valid",
    "T[left][5,5]": "out of range; allowed: rows 1 to 4",
    "T[left][1,4,2]": "3 indices of an entry",
    "J[left][7,1]": "out of range; allowed: rows 1 to 6, columns 1 to 5",
    "J[middle]": "end 'middle' of torso; allowed: left, right",
    "hessian[left]": "0 indices",
    "hessian[9]": "index 9; allowed: 1 to 5",
    "B[left]": "B of an end of torso, which is of the whole tree; leave 'left' out",
    "A[0]": "index 0; allowed: 1 to 5",
    "detJ[left]": "whose table is a tree",
    "singularities": "whose table is a tree",
}


def test_quantities_of_ends_and_rows_are_asked_for_by_name() -> None:
    model = Model(Robot.from_text(TORSO))
    assert {typed: by_ends(model, typed) for typed in ASKED} == ASKED
    for typed, wanted in WANTED.items():
        assert model.quantity(typed) == wanted(model), typed
    for typed, words in REFUSED.items():
        with pytest.raises(QuantityError, match=words):
            model.quantity(typed)
    with pytest.raises(QuantityError, match="the inverse kinematics of body, whose root moves; allowed: arms"):
        Model(Robot.from_text(BODY)).quantity("inverse[hand]")
