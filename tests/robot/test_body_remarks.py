"""Tensors that no body has are remarked on with the amount; those that some body has, and planar ones, are not."""

from fractions import Fraction

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from derive.robot.body_remarks import missing_moment, remarks_on_bodies
from derive.robot.load import catalogue_text
from derive.robot.reading.document import read_document
from derive.robot.robot import Robot


def remarks(inertia: str, tail: str = "") -> list[str]:
    text = (
        "name: arm\nconvention: standard\njoints:\n  - {type: revolute, a: 1}\ngravity: [0, 0, -9.81]\nlinks:\n"
        f"  - mass: 1\n    inertia: {{{inertia}}}\n{tail}"
    )
    robot = Robot.from_text(text, "arm.yaml")
    assert remarks_on_bodies(read_document(text.encode(), "arm.yaml"), robot) == robot.remarks
    return [str(remark) for remark in robot.remarks]


def test_a_tensor_that_no_body_has_is_remarked_on_with_the_amount() -> None:
    (remark,) = remarks("xx: 0.1, yy: 0.02, zz: 0.2")
    assert remark.startswith("arm.yaml:8:14: links entry 1, inertia: physically inconsistent: one principal moment ")
    assert "derive export --inertia possible" in remark
    (remark,) = remarks("xx: i1, yy: i1, zz: 3*i1", "parameters: {i1: 0.5}\n")
    assert "other two by 0.5 kg m^2" in remark


def test_several_links_are_one_remark() -> None:
    text = catalogue_text("puma560-corke").replace("inertia: {yy: 0.35}", "inertia: {xx: 0.1, yy: 0.35}")
    (remark,) = Robot.from_text(text, "my.yaml").remarks
    expected = (
        "links entries 1, 3, inertia: physically inconsistent: one principal moment "
        "exceeds the sum of the other two by 0.25, 0.0075 kg m^2"
    )
    assert expected in remark.found


def test_bodies_that_exist_planar_arms_and_symbols_are_not_remarked_on() -> None:
    for inertia in ("xx: 0.1, yy: 0.1, zz: 0.2", "zz: 0.2", "xx: 1, yy: i1, zz: 5", "xx: 0, yy: 0.1, zz: 0.1"):
        assert remarks(inertia) == []


def test_a_negative_moment_is_remarked_on_of_planar_arms_too() -> None:
    (remark,) = remarks("zz: -0.2")
    assert "one principal moment exceeds the sum of the other two by 0.2 kg m^2" in remark


def test_built_in_robots_are_remarked_on_like_files() -> None:
    copy = Robot.from_text(catalogue_text("puma560-corke"), "my.yaml")
    for (remark,) in (Robot.load("puma560-corke").remarks, copy.remarks):
        assert "links entry 3, inertia: physically inconsistent: " in remark.found
        assert "by 0.0075 kg m^2" in remark.found
        assert remark.is_of_bodies


@given(st.lists(st.integers(-9, 9), min_size=6, max_size=6))
def test_the_amount_is_that_of_the_principal_moments(cells: list[int]) -> None:
    xx, yy, zz, xy, xz, yz = cells
    a, b, c = np.linalg.eigvalsh(np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]], dtype=float))
    xx, yy, zz, xy, xz, yz = map(Fraction, cells)
    assert abs(missing_moment((xx, yy, zz, xy, xz, yz)) - max(0.0, c - a - b)) <= 1e-6
