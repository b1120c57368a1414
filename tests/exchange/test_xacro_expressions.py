"""A xacro file computes lengths, and runs nothing else."""

from __future__ import annotations

from pathlib import Path

import pytest
import xacro

from derive.errors import RobotFileError
from derive.exchange.source import forbidden, guarded, open_urdf

RUN = "('touch owned')"

FRAMES = (
    "[a for a in [[]] for g in [(g.gi_frame.f_back.f_back.f_back.f_globals for g in a)] for _ in [a.append(g)] "
    f"for r in g for _ in [r['os'].system{RUN}]]"
)

CLASSES = "[c for c in ().__class__.__base__.__subclasses__() if c.__name__ == '_wrap_close']"
LAMBDA = f"(lambda: {CLASSES}[0].__init__.__globals__['system']{RUN})()"

GLOBALS = "python.vars(python.type(xacro.arg))['_' + '_globals_' + '_']"
TYPES = f"python.vars(python.type({GLOBALS}))['_' + '_get_' + '_']({GLOBALS}, xacro.arg)['os'].system{RUN}"

HOSTILE = [f"${{{FRAMES}}}", f"${{{LAMBDA}}}", f"${{{TYPES}}}", "$(eval ${frames})"]


def file_with(value: str) -> str:
    return f'''<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:property name="type" value="revolute"/>
  <xacro:property name="size" value="${{dict(length=0.25, f_max=3, _n=2)}}"/>
  <xacro:property name="frames" value="{FRAMES}"/>
  <link name="l0"/><link name="l1"/><joint name="j" type="${{type}}"><parent link="l0"/><child link="l1"/>
  <origin xyz="{value} 0 0"/><axis xyz="0 0 1"/></joint></robot>'''


@pytest.mark.parametrize("value", HOSTILE)
def test_no_file_runs_a_command(value: str, tmp_path: Path) -> None:
    path = tmp_path / "arm.urdf"
    path.write_text(file_with(value))
    with pytest.raises(RobotFileError, match=r"is not (evaluated|defined)") as refused:
        open_urdf(path)
    assert "\n" not in str(refused.value)
    assert "--packages" not in refused.value.remedy or "is not defined" in refused.value.found
    assert [entry.name for entry in tmp_path.iterdir()] == ["arm.urdf"]


def test_what_one_expansion_writes_for_the_next_is_looked_at(tmp_path: Path) -> None:
    path = tmp_path / "arm.urdf"
    path.write_text(file_with("$" + HOSTILE[1]))
    with pytest.raises(RobotFileError, match="uses __"):
        open_urdf(path)
    assert not (tmp_path / "owned").exists()


@pytest.mark.parametrize(
    "value",
    [
        "${size['length']}",
        "${python.sum([0.2, 0.05])}",
        "${'%.2f' % (1 / 4)}",
        "$(eval 1/4.0)",
        "${(lambda x: x / size['_n'])(0.5)}",
        "${[k / 4 for k in python.range(2)][1]}",
    ],
)
def test_sums_of_lengths_are_evaluated(value: str, tmp_path: Path) -> None:
    path = tmp_path / "arm.urdf"
    path.write_text(file_with(value))
    assert float(open_urdf(path).urdf.joints[0].origin.xyz[0]) == 0.25


def test_other_users_of_xacro_find_it_as_it_was() -> None:
    before, offered = xacro.safe_eval, dict(xacro._global_symbols["python"])
    with guarded():
        assert xacro.safe_eval is not before
    assert xacro.safe_eval is before
    assert dict(xacro._global_symbols["python"]) == offered
    assert forbidden("limits.f_max + type") is None
