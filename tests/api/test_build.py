"""`derive.build` and its like do what the commands do."""

from pathlib import Path

import pytest

import derive
from derive.api.build import build, stale, verify
from derive.errors import VerificationError

ARM = "name: arm\nconvention: standard\njoints:\n  - {type: revolute, a: a1}\n"


def test_a_robot_is_built_verified_and_current(tmp_path: Path) -> None:
    (tmp_path / "arm.yaml").write_text(ARM)
    out = tmp_path / "models"
    (before,) = stale([tmp_path / "arm.yaml"], out, effort="quick")
    built = derive.build(tmp_path / "arm.yaml", out, targets=["numpy"], only=True, effort="quick")
    assert built.folder == out / "arm"
    assert {file.name for file in built.folder.iterdir()} == set(built.files)
    assert built.report.worst < 1e-9
    assert build(tmp_path / "arm.yaml", out, targets=["numpy"], only=True, effort="quick").unchanged
    (after,) = stale([tmp_path / "arm.yaml"], out, targets=["numpy"], only=True, effort="quick")
    assert (before.is_current, after.is_current) == (False, True)  # type: ignore[union-attr]
    assert verify(tmp_path / "arm.yaml", out, samples=3).worst < 1e-9
    (tmp_path / "arm.yaml").write_text(ARM.replace("a: a1", "d: a1"))
    with pytest.raises(VerificationError, match=r"built from another robot file than .*; run: derive build"):
        verify(tmp_path / "arm.yaml", out, samples=3)
