"""What is wrong is refused by every command: status 2, one message, nothing printed and nothing written."""

import shlex
from pathlib import Path

import pytest

from tests.cli.command import PENDULUM, PLANAR, contents, refused
from tests.exchange.urdfs import J, urdf

FILES = {
    "arm.yaml": PENDULUM,
    "taken.yaml": "x",
    "folder/file": "x",
    "planar.yaml": PLANAR,
    "right.yaml": "robot: {name: p, convention: standard, joints: [{type: revolute, a: a1}]}\n"
    "expected:\n  - {quantity: p, entries: {'1': a1*c1}}\n",
    "plan.yaml": "robot: planar.yaml\npoints: {a: [0, 0], b: {pose: {p: [0.7, 0.2, 0]}}}\n"
    "path: [a, {to: b, time: 1, line: yes}]\n",
    "notes.md": "# Arm\n$x = a_1 c_1 + a_2 c_{12}$\n",
    "empty.md": "# No formula\nhere\n",
    "arm.urdf": urdf([J("0 0 0.3"), J("0.4 0 0", type="fixed", link="tool")]),
}
PACKAGES = {"plot": "matplotlib", "map": "xarray", "import": "lxml"}
REFUSED = r"""
frobnicate
--quiet list => no option '--quiet' before the command; see 'derive --help'
--vers => no option '--vers'; did you mean '--version'?
shwo => did you mean 'show'?
biuld => did you mean 'build'?
help shwo => did you mean 'show'?
list --frobnicate
list --js
list --jsn => did you mean '--json'?
build missing.yaml
build scara-perugia --jobs 0
build thumb --effort quik => did you mean 'quick'?
build thumb --target numpi => did you mean 'numpy'?
check missing.yaml
check .
check scara-perugia
check x --quantity T
check
check right.yaml --report right.yaml/report.md
check planar-2r-perugia --latex missing.tex
check arm.yaml --latex 'x = 1' --lines 3 => --lines and --section choose a part of a document; give a file
check arm.yaml --latex notes.md --lines b-3 => 'b-3' is not a range of lines such as 20-80
check planar-2r-perugia planar-3r --latex 'x = a_1 c_1' => several robots for one formula
check planar-2r-perugia planar-2r-perugia --latex notes.md => two robots are called 'planar-2r-perugia'
check planar-2r-perugia planar-3r --latex empty.md => no mathematics between
completion bsh => did you mean 'bash'?
completion tcsh => no shell 'tcsh'; allowed: bash, zsh, fish; see
convert thumb --convention craig => unknown convention 'craig'; allowed: standard (distal), modified (Craig, Khalil)
convert thumb --convention modifid => did you mean 'modified'?
convert thumb --convention standard => thumb has a standard table already; write --convention modified
convert thumb --name Thumb => 'Thumb' is not a robot name; allowed: a-z, 0-9 and -
convert thumb --format latex => --format latex without --derivation; add --derivation
convert thumb -o . => '.' is a folder; write the name of a file in it
convert thumb -o taken.yaml => taken.yaml exists already; choose another name
convert thumb -o folder --force => folder
convert puma560-corke --inertia posible => did you mean 'possible'?
excite puma560-corke -o out.yaml => q1, q2, q3, q4, q5, q6 of puma560-corke without limits of speed; write speed:
excite puma560-corke -o out.yaml --floor x => --floor: invalid height value: 'x'
export planar-2r-perugia --to urdf => symbols without a number: a1, a2, g, ml1, l1, Il1, mm1, Im1, ...;
export kuka-kr5 --to sdf => 'sdf' as --format; allowed: urdf, mjcf, rtb, corke, rigidbodytree, csv
export kuka-kr5 --to mjfc => did you mean 'mjcf'?
export kuka-kr5 => required: --format
export anthropomorphic-arm --to csv --values a2 => 'a2' in --values; allowed: name=value,name=value
export anthropomorphic-arm --to csv --values a2=1,a2=2 => a2 twice in --values
export anthropomorphic-arm --to csv --values a2=x => value 'x' of a2 holds a name
export anthropomorphic-arm --to csv --values b=1 => no 'b' in anthropomorphic-arm; allowed: a2, a3
export nobody --to csv => nobody
export kuka-kr5 --to csv -o . => '.' is a folder; write the name of a file in it
export kuka-kr5 --to csv -o . --force => '.' is a folder; write the name of a file in it
handout arm.yaml --parts inerta => inerta ... newton-euler ... did you mean 'inertia'
handout thumb --parts tabel => did you mean 'table'?
handout arm.yaml --parts , => allowed
handout arm.yaml --notation angel=q => angel ... did you mean 'angle'
handout arm.yaml --notation inertia=X => X ... B, M, D
handout arm.yaml --lang klingon => klingon ... en, it, pt
handout thumb --lang eng => did you mean 'en'?
handout arm.yaml --derivation proofs => proofs ... steps
handout arm.yaml --fragment inerta => inerta ... did you mean 'inertia'
handout arm.yaml --fragment B[2,2] => rows 1 to 1
handout arm.yaml --fragment B --pdf => --fragment with --pdf
handout arm.yaml --fragment B --width wide => width 'wide' ... such as 84mm
handout arm.yaml --width 84mm => --width works only with --fragment
handout arm.yaml -o x.tex => -o x.tex works only with --fragment ... name a folder
handout arm.yaml -o - => -o - works only with --fragment ... name a folder
handout arm.yaml --pages many => many ... a whole number such as 20
handout arm.yaml -q 1,2 => joint values are needed, 2 given
handout planar-2r-perugia --style-from missing.yaml
handout arm.yaml --out arm.yaml => arm.yaml
import none.urdf
import arm.urdf --tip nothing
import arm.urdf --chain l0
import arm.urdf --chain l0..tool --tip tool
import arm.urdf --all --tip tool
import arm.urdf --convention craig
import arm.urdf --snap much
import arm.urdf --inertia better
import arm.urdf --arg name
import arm.urdf -o .
import .
map planar.yaml -o s.zarr --grid -1 => a grid of -1 m; allowed: the side of a cell in metres, above zero
map planar.yaml -o s.zarr --orientations 0 => '0' is not a whole number from 1
map planar.yaml -o s.zarr --box 0,x => '0,x' is not a list of numbers such as 0.2,0.6
map planar.yaml -o s.zarr --box 0,1 => the box 0, 1 is not one that the arm reaches; allowed: x0,x1,y0,y1 within x from
map planar.yaml -o s.zarr --grid 1e-5 => a map of 3.24e+10 poses: up to 292 GB and about 9 h of one core; allowed: 1e+10
map planar.yaml -o s.zarr --workers 2 --scheduler tcp://127.0.0.1:9 => --workers with --scheduler
map planar.yaml -o s.zarr --plot a.txt => has the ending of another kind of file
move scara-pick => 'scara-pick' is neither a file nor a built-in plan; allowed: a path, or a name
move scara-pick-and-plce => did you mean 'scara-pick-and-place'?
move plan.yaml --csv a.csv => plan.yaml:3:11: the arm does not reach the way
move scara-pick-and-place --format latex
move scara-pick-and-place --show --json => --show with --json
move scara-pick-and-place --csv - --json => --csv - with another output
move scara-pick-and-place --csv . => is a folder
move scara-pick-and-place --csv a.svg --plot a.svg => two contents
move scara-pick-and-place --part sheet.doc
new ../arm
new Arm
new arm --joints 0
new arm --joints 257
new a b => 'b' is an argument too many; see 'derive new --help'
new b --from scara-perugia --joints 3
new b --from no-such-robot
new x --plan thumb --joints 2 => --joints with --plan
new X! --plan thumb
plot planar-2r-perugia -q 1 -o a.svg
plot planar-2r-perugia -q 1,2,3 -o a.svg
plot planar-2r-perugia -q 1, -o a.svg
plot planar-2r-perugia -q 1,a1 -o a.svg
plot planar-2r-perugia -q 1,1/0 -o a.svg
plot planar-2r-perugia -q 1,sqrt(-1) -o a.svg
plot planar-2r-perugia -q 1,2 --workspace -o a.svg
plot planar-2r-perugia --size nan -o a.svg
plot planar-2r-perugia -o a.eps
plot planar-2r-perugia -o a
plot planar-2r-perugia
plot thumb -o => -o/--out: expected one argument
plot puma560-corke --ot a.svg => did you mean '--out'?
plot puma560-corke --forec -o a.svg => did you mean '--force'?
sample planar.yaml dJ/dt --speed fast => 'fast' is not a number, nor numbers with commas between
sample planar.yaml tau => planar has no inverse_dynamics
show scara-perugia Q
show scara-perugia A[9]
show scara-perugia A[0]
show thumb B
show . T
show -thumb p => no option '-thumb'
show puma560-crke p => did you mean 'puma560-corke'?
show puma560-corke potentail => did you mean potential?
show puma560-corke p --fromat text => did you mean '--format'?
show puma560-corke p --format latx => did you mean 'latex'?
show thumb inverse --task positon => did you mean 'position'?
show arm.yaml B --format => expected one argument
show arm.yaml B --digits 0
show arm.yaml B --digits 4 --exact
show arm.yaml B --digits 4 --format json => --digits with --format json
show arm.yaml B --at '1, 2' => 2 values
show arm.yaml B --at x=1 => 'x'
show arm.yaml B --at 'q1=1, q1=2' => twice
show arm.yaml B --at a1 => holds a name
show arm.yaml B --at 0 --rates '1 1' => value
show arm.yaml B --at __import__("os") => value
show planar-2r-perugia inverse --task x,y,z => a task of 3 coordinates for 2 joints
show planar-2r-perugia inverse --task x,w => unknown row of a task 'w'
show planar-2r-perugia inverse --given q7 => 'q7' is not a joint variable
show planar-2r-perugia inverse --task z => no joint changes the task z; allowed: x, y, phi, orientation
show planar-2r-perugia workspace --at 0,0 => --at with workspace; ask for workspace without --at
show planar-2r-perugia aspects --abbreviate christoffel => --abbreviate with aspects
show planar-2r-perugia aspects --format latex => --format latex with aspects; allowed: text and json
show planar-2r-perugia decoupling --format python => --format python with decoupling; allowed: text and json
show planar-2r-perugia T --task x,y => --task with T; allowed: with inverse, singularities, workspace and aspects
show planar-2r-perugia B detJ --given q1 => --given with B; allowed: with inverse, workspace and aspects
show planar-2r-perugia workspase => quantity 'workspase'; did you mean 'workspace'?
show planar-2r-perugia Aspects => quantity 'Aspects'; did you mean 'aspects'?
style planar-2r-perugia
style planar-2r-perugia --example 'a1*c1 + a2*c12'
style planar-2r-perugia --example '= a1*c1 + a2*c12'
style planar-2r-perugia --example 'p = a1*c1 + a2*c12'
style planar-2r-perugia --example 'a_1 c_1 + a_2 c_{12}'
style planar-2r-perugia --example 'p_x = a_1 c_1 + z c_{12}'
style planar-2r-perugia --example missing.tex
style planar-2r-perugia --example 'nothing[1] = a1*c1 + a2*c12'
style planar-2r-perugia --example 'p[1] = a1*c1 + zz*c12'
style planar-2r-perugia --example 'p[1] = a1*(c1 + '
style planar-2r-perugia scara-perugia --example 'p[1] = a1*c1 + a2*c12'
style no-such-robot --example 'p[1] = a1*c1 + a2*c12'
style
"""
"""What is typed, and words of the message, with dots between."""


@pytest.mark.parametrize("row", REFUSED.strip().splitlines())
def test_what_is_wrong_is_one_message_and_writes_nothing(row: str, tmp_path: Path) -> None:
    typed, _, words = row.partition(" => ")
    pytest.importorskip(PACKAGES.get(typed.split()[0], "derive"))
    (tmp_path / "folder").mkdir()
    for name, text in FILES.items():
        (tmp_path / name).write_text(text)
    before = contents(tmp_path)
    done = refused(*shlex.split(typed), folder=tmp_path)
    assert contents(tmp_path) == before
    assert "json" in typed or not done.stdout
    assert all(each in done.stderr for each in words.split(" ... ")), done.stderr
