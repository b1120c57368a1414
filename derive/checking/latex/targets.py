r"""What left sides of printed equations may mean: ``\mathbf{T}^0_6``, ``b_{11}``, ``\tau_1``, ``p_x`` as quantities.

Books agree on no letter, and one letter means several things: T is a transform or the kinetic energy. So a left side
has candidates, the likeliest first; the shape of what is printed and, last, which of them it equals decide.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass, replace

from derive.checking.latex.left import AXES, Left, Reading, Scripts, Turned
from derive.checking.latex.quantities import OF_LINK, STATICS
from derive.model.quantities import REGISTRY

Indices = tuple[int, ...]

_END = frozenset((
    "e", "ee", "eef", "eff", "E", "EE", "EEF", "n", "N", "t", "tool", "Tool", "TOOL", "tcp", "TCP", "H", "h", "end",
    "hand", "Hand", "e.e.", "e.e", "F", "G", "gripper", "Gripper", "grip", "tip", "flange", "fingertip", "endeffector",
    "target", "goal", "desired", "des", "arm", "total", "final",
))  # fmt: skip
_TARGETS = ("des", "desired", "target", "goal", "d")
_BASE = frozenset(["0", "b", "B", "base", "Base", "BASE", "baselink", "world", "World", "w", "W", "s", "S", "O", "o"])
_LINEAR = ("v", "P", "p", "L", "l", "pos", "lin")
_ANGULAR = ("omega", "w", "O", "o", "A", "R", "Theta", "theta", "Omega", "ang", "rot")


@dataclass(frozen=True, slots=True)
class Target:
    """A quantity, or some rows and columns of it."""

    quantity: str  # its name in the registry
    rows: Indices = ()  # the rows that are meant; none for all
    columns: Indices = ()  # the columns that are meant; none for all
    is_determinant: bool = False  # whether its determinant is meant
    turned: Turned = Turned.NOT  # whether the transpose of these rows and columns is meant, their inverse, or both
    entry: Indices = ()  # row and column of the one entry of all this that is meant
    # By what it is differentiated: a joint variable or its velocity, "q", "qd" (all of them), "t".
    by: tuple[str, ...] = ()


def names_end(left: Left) -> bool:
    """Whether a pose is that of the end effector by its name, such as ``{}^0_{ee}T``."""
    letters = _END - {"n", "N", "t"}  # the last frame's number, and time
    return left.head in "TAH" and not {left.sub, left.before_sub}.isdisjoint(letters)


def candidates(
    left: Left, n: int, first: int = 1, reading: Reading = frozenset(), *, tool: bool = False
) -> tuple[Target, ...]:
    """What a left side may mean, the likeliest first; the frame behind the last one is that of a tool."""
    if left.is_of_parameters and left.head != "J":
        return ()
    if left.scripts in reading:  # the two frames in each other's place
        match left.scripts:
            case Scripts.LEFT:
                left = replace(left, before=left.before_sub, before_sub=left.before)
            case Scripts.RIGHT:
                left = replace(left, sub=left.sup, sup=left.sub)
            case Scripts.PAIR:
                left = replace(left, sub=left.sub[::-1])
    if tool and str(n + 1) in (left.sub, left.before_sub) and left.sup + left.before in _BASE:
        left = replace(left, sub="tool" if left.sub else "", before_sub="tool" if left.before_sub else "")
    found = (*_named(left), *_dynamics(left, n), *_velocities(left, n), *_jacobians(left, n))
    is_coordinate = left.head in AXES and not re.fullmatch("[cCGm][1-9]", left.sub)
    still = left if is_coordinate or left.sub[:1] in AXES else replace(left, dots=0)
    for label in dict.fromkeys((first, 1)):
        found = (*found, *(replace(target, by=("t",) * left.dots) for target in _kinematics(still, n, label)))
    if left.is_determinant:
        whole = [Target("singularities" if left.primes else "detJ")] if left.head == "J" and not left.sub else []
        parts = (t for t in found if left.head in ("R", "C", "J") or not t.quantity.startswith(("T", "A")))
        found = (*whole, *(replace(target, is_determinant=True) for target in parts))
    return tuple(dict.fromkeys(replace(target, turned=left.turned) for target in found))


_VECTORS = frozenset(
    ("g", "tau", "Cqd", "B_qdd", "momentum", "p", "rpy", "euler_zyz", "friction", "centre", "bias", *STATICS, *OF_LINK)
)
_SCALARS = ("christoffel", "manipulability", "kinetic", "potential", "lagrangian", "detJ", "singularities")


def is_scalar(target: Target) -> bool:
    """Whether a target is one formula."""
    entry = len(target.rows) == 1 and (len(target.columns) == 1 or target.quantity.partition("[")[0] in _VECTORS)
    return entry or bool(target.entry) or target.is_determinant or target.quantity.startswith(_SCALARS)


def _named(left: Left) -> Iterator[Target]:
    """Names of the registry itself, and words for angles."""
    for name in REGISTRY:
        if len(name) > 2 and left.flat.casefold() == name.replace("_", "").casefold():
            yield Target(name)
    angles, euler = ("roll", "pitch", "yaw"), ("phi", "theta", "psi")
    if left.head in euler and not left.sub + left.sup + left.before:
        index = euler.index(left.head) + 1
        yield from (Target("task", (3,)), Target("euler_zyz", (index,)), Target("rpy", (4 - index,)))
    if (word := left.sub if left.head in euler else left.head if not left.sub else "") in angles:
        yield Target("rpy", (angles.index(word) + 1,))
    if left.head == "phi" and left.sub in ("RPY", "rpy"):
        yield Target("rpy")
    if left.head == "phi" and left.sub.casefold() == "zyz":
        yield Target("euler_zyz")


# Letters that books use for dynamics.
_DYNAMIC = {
    "B": ("B",), "M": ("B",), "D": ("B",), "I": ("B",), "C": ("C", "Cqd"), "S": ("C",),
    "g": ("g",), "G": ("g",), "tau": ("tau",), "Q": ("tau",), "u": ("tau",), "Gamma": ("tau",),
    "F": ("tau",), "V": ("Cqd",), "c": ("C", "Cqd"), **dict.fromkeys("hH", ("B", "Cqd", "bias")),
    **dict.fromkeys("nN", ("N", "bias")), "b": ("B", "bias"), "f": ("tau",), "m": ("B",), "d": ("B",), "v": ("Cqd",),
    "Y": ("regressor", "regressor_base"), "W": ("regressor",),
}  # fmt: skip
_ENERGIES = {"L": "lagrangian"} | dict.fromkeys(("T", "K", "KE", "Ek", "Ec", "EK", "Ekin", "Tkin"), "kinetic")
_ENERGIES |= dict.fromkeys(("U", "V", "P", "PE", "Ep", "EP", "Epot", "Upot", "Eg"), "potential")


def _dynamics(left: Left, n: int) -> Iterator[Target]:
    if left.sup or left.before or left.before_sub or left.primes:
        return
    indices = _indices(left.sub, n)
    if left.head in ("c", "C", "Gamma") and len(indices) == 3:
        yield Target("christoffel[" + ",".join(map(str, indices)) + "]")
    quantities = _DYNAMIC.get(left.head, ())
    # only the rate of the inertia matrix has a dot; C q' and B q'' are the torques of velocities and accelerations
    if left.dots or left.factor:
        is_rate = left.dots == 1 and left.head in "BMDHbmdh" and not left.factor
        product = "Cqd" if left.head in "CS" and left.factor == "d" else ""
        product = "B_qdd" if left.head in "BMDH" and left.factor == "dd" else product
        quantities = ("Bdot",) if is_rate else (product,) if product else ()
    if left.head in "BHV" and "dot" in left.arguments:  # B(q, qd), the torques of velocities
        quantities = (*quantities, "Cqd")
    if left.head in "Ff" and "dot" in left.arguments:
        quantities = (*quantities, "friction")
    for quantity in quantities:
        is_vector = quantity in _VECTORS
        if not left.sub:
            yield Target(quantity)
        elif len(indices) == (1 if is_vector else 2) and not quantity.startswith("regressor"):
            yield Target(quantity, indices[:1], indices[1:])
    if left.head in "BC" and not (left.sub + left.factor or left.dots or "dot" in left.arguments):
        yield Target("coriolis" if left.head == "B" else "centrifugal")
    if left.head == "tau" and left.sub in ("g", "G"):
        yield Target("g")
    if left.head in "gG" and left.sub in ("", "0") and not left.dots + len(left.factor + left.arguments):
        yield Target("gravity")
    energy = _ENERGIES.get(left.head if left.sub == "tot" else left.flat, "")
    if left.flat in ("k", "u"):  # of the arm, or names of anything
        energy = "kinetic" if left.flat == "k" else "potential"
    if energy and not left.dots and not left.factor:
        yield Target(energy)
    of_link = _ENERGIES.get(left.head, {"k": "kinetic", "u": "potential"}.get(left.head, ""))
    if of_link and left.head != "L" and len(indices) == 1 and not left.dots and not left.factor:
        yield Target(f"{of_link}[{indices[0]}]")


def _velocities(left: Left, n: int) -> Iterator[Target]:
    """Of the end effector, and of the joints."""
    is_velocity = (left.head in ("v", "V", "xi", "nu") and not left.dots) or (left.head in "pPX" and left.dots == 1)
    if is_velocity and left.sub in (*_END, "") and left.sup + left.before in ("", *_BASE):
        yield from (Target("twist", rows) for rows in ((), (1, 2, 3), (1, 2), (1, 2, 6)))
    yield from _of_link(left, n)
    if left.head == "omega" and not left.dots and left.sub in (*_END, "") and left.sup + left.before in ("", *_BASE):
        yield from (Target("twist", rows) for rows in ((4, 5, 6), (6,)))
    point = re.fullmatch(r"([cCG]?)([1-9])", left.sub) if left.head == "v" and not left.dots else None
    if point is not None and left.sup in ("", "0"):
        at = (Target(f"T[0,{point[2]}]", (1, 2, 3), (4,)), Target(f"centre[{point[2]}]"))[bool(point[1]) :]
        yield from (replace(t, rows=rows, by=("t",)) for t in at for rows in ((1, 2, 3), (1, 2)))
    if left.head == "omega" and left.sub in AXES and not left.dots and left.sup + left.before in ("", *_BASE):
        yield Target("twist", (AXES[left.sub] + 3,))
    if left.head in ("q", "theta") and left.dots in (1, 2) and not left.sub + left.sup + left.arguments:
        yield Target("rates" if left.dots == 1 else "accelerations")


# Letters of Newton and Euler's recursion with their dots, of a frame and of a centre of mass; gravity counts as an
# acceleration, or it does not.
_RECURSION = {
    ("omega", 0, False): ("omega",), ("omega", 1, False): ("alpha",), ("alpha", 0, False): ("alpha",),
    ("v", 0, False): ("velocity",), ("v", 1, False): ("acceleration", "still_acceleration"),
    ("v", 1, True): ("acceleration_com", "still_acceleration_com"),
    ("a", 0, False): ("acceleration", "still_acceleration"),
    ("a", 0, True): ("acceleration_com", "still_acceleration_com"), ("F", 0, False): ("inertial_force",),
    ("N", 0, False): ("inertial_moment",), ("f", 0, False): ("joint_force",), ("n", 0, False): ("joint_moment",),
}  # fmt: skip


def _of_link(left: Left, n: int) -> Iterator[Target]:
    r"""Motion of a link and forces on it, in the axes of a frame: ``{}^2\dot v_{C_2}``, ``{}^1n_1``, ``{}^2F_{2y}``."""
    match, frame = re.fullmatch(r"([cCgG]?)([0-9]|e|E|ee|EE)([xyz]?)", left.sub), left.sup or left.before or "0"
    kinds = _RECURSION.get((left.head, left.dots, bool(match and match[1])), ())
    # v_2^2 is a square, or relative to another frame
    is_other = left.sup and left.before + left.sup != "00" and (left.before or left.head in "vaFN")
    if match is None or not kinds or not frame.isdigit() or is_other:
        return
    link = int(match[2]) if match[2].isdigit() else n + 1
    has_end = kinds[0] in ("velocity", "omega", "joint_force", "joint_moment")
    if int(frame) > n + (left.head in "fn") or link > n + has_end or (frame == "0" and left.head != "omega"):
        return
    rows = [(AXES[match[3]],)] if match[3] else [(), (3,)] if left.head in ("omega", "alpha") else [()]
    yield from (Target(f"{kind}[{link},{int(frame)}]", part) for kind in kinds for part in rows)


_SCREW_PARTS = {"omega": ((4, 5, 6),), "w": ((4, 5, 6),), "v": ((1, 2, 3),)}
_SPACE, _BODY = ("s", "S", "space", "spatial"), ("b", "B", "body")


def _screws(left: Left, n: int) -> Iterator[Target]:
    r"""Axes of the joints in the home position, as (omega, v) or (v, omega): ``\mathcal{S}_1``, ``\omega_1``."""
    part = re.fullmatch("(omega|w|v)([1-9])", left.sub) if left.head in ("S", "B") else None  # S_{v_1}
    rows = ((1, 2, 3) if part[1] == "v" else (4, 5, 6)) if part else ()
    number = part[2] if part else left.sub
    if not left.is_plain or not number.isdigit() or not 0 < int(number) <= n:
        return
    if part:
        yield Target(f"{'screw' if left.head == 'S' else 'body_screw'}[{number}]", rows)
        return
    for kind, heads in (("screw", ("S", "xi", "s")), ("body_screw", ("B", "xi"))):
        orders = ((4, 5, 6, 1, 2, 3), ()) if left.head in heads else _SCREW_PARTS.get(left.head, ())
        yield from (Target(f"{kind}[{left.sub}]", rows) for rows in orders)


def _jacobians(left: Left, n: int) -> Iterator[Target]:
    if left.head not in ("J", "j") or left.factor:  # J qd is a product of two names
        yield from _screws(left, n)
        return
    if left.dots:
        whole = ((), (1, 2), (1, 2, 3), (1, 2, 6)) if left.dots == 1 and not left.sub else ()
        yield from (Target("J_dot", rows) for rows in whole)
        return
    # J_{v,c_1} and {}^{T_6}J
    sub, sup = re.sub("(?<=[A-Za-z]),", "", left.sub), re.sub("^T(?=[0-9]$)", "", left.sup or left.before)
    # Jacobians of a body, J_P^{(l_2)} of a link and J_P^{(m_2)} of a motor, or with one subscript, J_{vc2}
    body = re.fullmatch(r"([lmc]|C|G)?([0-9]+)", sup.strip("*"))
    own = re.fullmatch(r"(v|omega|w|P|O)(l|m|c|C|G)([0-9]+)", sub)
    kind, index = (sub, body) if body and sub in (*_LINEAR, *_ANGULAR) else (own[1], own) if own else ("", None)
    if body and body[1] and (column := re.fullmatch("([PO])([1-9])", sub)) and int(column[2]) <= n:
        yield Target(f"J{'v' if column[1] == 'P' else 'w'}_com[{body[2]}]", (), (int(column[2]),))
    if index is not None and (index[1] or not own):
        letter, number = (index[2], index[3]) if own else (index[1], index[2])
        where = "motor" if letter == "m" else "com"
        if letter or own:
            yield Target(f"J{'v' if kind in _LINEAR else 'w'}_{where}[{number}]")
            return
    if left.primes:
        yield from [Target("J_11_reduced")] if sub == "11" else ()
        return
    # the end effector's, seen from the base or from the end effector itself; whole, or the rows of its task
    frames = [sub] if sub in _END or sub in _BASE or sub == str(n) else []
    in_end = sup in _END or sup in (str(n), str(n + 1)) or bool(frames and (sub in _END or sub == str(n)))
    if sup and not in_end and sup not in _BASE:
        return
    names = ["J_end", "J"] if in_end else ["J"]
    names += ["J_space"] if _SPACE.count(sub + sup) else ["J_end"] if _BODY.count(sub + sup) else []
    indices = _indices(sub, n) if not frames or sub == str(n) else ()
    if sub in ("w", "W", "wrist", "wc") and n > 3:
        at = (f"J_at[{k}]" for k in (n - 2, n - 1))
        yield from (Target(name, rows) for name in at for rows in ((), (1, 2, 3)))
    if not sub or frames or sub in ("q", "theta"):
        yield from (Target(name, rows) for name in names for rows in ((), (1, 2), (1, 2, 3), (1, 2, 6)))
    parts = ((1, 2, 3), (1, 2), (1, 2, 6)) if sub in _LINEAR else ((4, 5, 6), (6,)) if sub in _ANGULAR else ()
    yield from (Target(name, rows) for name in names for rows in parts)
    if sub in ("A", "a", "RPY", "rpy"):
        yield Target("J_rpy")
    if sub in ("A", "a", "ZYZ", "zyz", "E"):
        yield Target("J_zyz")
    if sub in ("11", "12", "21", "22"):
        yield Target(f"J_{sub}")
        rows, columns = ((1, 2, 3) if k == "1" else (4, 5, 6) for k in sub)
        yield from (Target(f"J_at[{k}]", rows, columns) for k in (4, 5) if n == 6)  # of the wrist
    yield from _jacobian_parts(sub, n, indices, "J_end" if sup and in_end else "J")


def _jacobian_parts(sub: str, n: int, indices: Indices, name: str) -> Iterator[Target]:
    match = re.fullmatch(r"([A-Za-z]+)([0-9]+)", sub)
    if match and int(match[2]) <= n and match[1] in (*_LINEAR, *_ANGULAR):
        rows, kind = ((1, 2, 3), "v") if match[1] in _LINEAR else ((4, 5, 6), "w")
        yield from (Target(name, rows, (int(match[2]),)), Target(f"J{kind}_com[{match[2]}]"))
    match = re.fullmatch(r"([A-Za-z]+)([1-3])([1-9])", sub)
    if match and int(match[3]) <= n and match[1] in (*_LINEAR, *_ANGULAR):
        yield Target(name, (int(match[2]) + 3 * (match[1] in _ANGULAR),), (int(match[3]),))
    if len(indices) == 1:
        yield from (Target(name, rows, indices) for rows in ((), (1, 2, 3), (1, 2)))
    if len(pair := _indices(sub, max(n, 6))) == 2 and pair[0] <= 6 and pair[1] <= n:
        yield Target(name, pair[:1], pair[1:])
        if pair[0] <= 3:  # J_31 of a J_omega
            yield Target(name, (pair[0] + 3,), pair[1:])


_OF_ONE_ANGLE = re.compile(r"[({]+-?\\?(?:var)?(?:theta|phi|q|alpha)_?\{?[1-9]?\}?[)}]+")  # R(\theta_1), a turn
_COLUMNS = {"n": 1, "s": 2, "o": 2, "a": 3}  # of a rotation


def _kinematics(left: Left, n: int, first: int) -> Iterator[Target]:
    """Transforms, rotations, positions, and their entries."""
    plain = not (left.sup or left.before or left.before_sub)
    is_turn = plain and n > 1 and not left.sub and _OF_ONE_ANGLE.fullmatch(left.arguments)
    if left.dots or left.primes or left.factor or is_turn:
        return
    head, pair = left.head, _indices(left.sub, 4)
    if head in ("T", "A", "H", "K", "M"):
        for name in _frames(left, n, first):
            # of three rows the rotation alone, or the plane of a planar arm
            parts = ((1, 2, 3), (1, 2, 4)) if head == "T" else ((1, 2, 4),)
            yield from (Target(name), *(Target(name, part, part) for part in parts), Target(name, (1, 2, 3)))
        if head in "TH" and plain and not left.sub:  # of the frame that a section is about
            yield from (Target(f"T[0,{k}]") for k in range(1, n + 1))
    if head in ("R", "C", "Rot") and not (head == "C" and plain):
        for name in _frames(left, n, first):
            yield from (Target(name, (1, 2, 3), (1, 2, 3)), Target(name, (1, 2), (1, 2)))
    if head in ("R", "r", "T", "t", "a", "A", "H") and plain and len(pair) == 2:
        yield Target("T", pair[:1], pair[1:])
    yield from _seen_from(left, n)
    # entries of a vector, p_x or n_y, and coordinates by their own letters, x_E
    of_vector = left.sub[:1] in AXES and left.sub[1:] in ("", *_END)
    is_axis = (
        head.lower() in AXES and left.sub in ("", "P", "p", "g", "goal", *(_END - {"arm"})) and not left.before_sub
    )
    if of_vector or is_axis:
        row = (AXES[left.sub[0] if of_vector else head.lower()],)
        columns = {"n": (1,), "s": (2,), "o": (2, 4), "a": (3,)}.get(head, ()) if of_vector else ()
        if (not of_vector or head in ("p", "P", "o", "O", "x", "X", "r", "d")) and not left.labelled:
            yield Target("p", row)
        yield from (Target("T", row, (column,)) for column in columns if plain)
        if not of_vector and head in ("x", "X"):
            yield from (Target("p"), Target("p", (1, 2)), Target("task"))
        return
    if head in AXES and left.sub.isdigit() and plain and (frame := _frame(left.sub, n, 1)):
        yield from (Target(f"T[0,{k}]", (AXES[head],), (4,)) for k in (frame, frame + 1) if k <= n)
    if head in AXES and plain and left.sub.lower() in ("elbow", "wrist"):
        yield from (Target(f"T[0,{k}]", (AXES[head],), (4,)) for k in range(1, n))
    if head in _COLUMNS and plain and left.sub in ("", *_END):
        yield Target("T", (1, 2, 3), (_COLUMNS[head],))
    if left.sub.isdigit() and (head == "Y" or (head in ("x", "y") and left.sup + left.before)):  # axes, as z_2^0
        yield from (Target(name, (1, 2, 3), (AXES[head.lower()],)) for name in _frames(left, n, first))
    elif head in ("p", "P", "o", "O", "d", "r", "x", "X", "t") or (head in "fF" and plain and left.arguments):
        if not left.sub and not left.sup:
            yield from (Target("p"), Target("p", (1, 2)), Target("in_plane"))
        for name in _frames(left, n, first):
            yield from (Target(name, rows, (4,)) for rows in ((1, 2, 3), (1, 2), (1, 2, 4)))
        if head == "r" and left.sub.isdigit() and left.sup + left.before in ("", "0"):
            yield from (Target(f"centre[{int(left.sub)}]", rows) for rows in ((), (1, 2)))
    if head in ("z", "Z") and (left.sub or left.before):
        yield from (Target(name, (1, 2, 3), (3,)) for name in _frames(left, n, first))


def _seen_from(left: Left, n: int) -> Iterator[Target]:
    """Centres of mass, and entries of a pose: {}^1P_{C_1}, P_{6x}^0, n_{4z}^1, {}^1p_x of the end effector."""
    frame, way = left.sup or left.before or "0", re.fullmatch("([0-9]),([0-9])", left.sub)
    if way and left.head in ("p", "r", "d") and way[1] == frame and left.sup and int(way[1]) < int(way[2]) <= n:
        yield from (Target(f"T[{frame},{way[2]}]", rows, (4,)) for rows in ((1, 2, 3), (1, 2)))  # r_{1,4}^1
    place, centre = re.fullmatch(r"([1-9]?)([xyz])", left.sub), re.fullmatch(r"[cCGm]([1-9])", left.sub)
    if left.head in ("p", "P", "r", "x", "X") and frame.isdigit() and centre:
        name = f"centre[{centre[1]}]" if frame == "0" else f"centre[{centre[1]},{frame}]"
        yield from (Target(name, rows) for rows in ((), (1, 2)))
        yield from (Target(f"centre_task[{centre[1]}]"),) if frame == "0" else ()
    if left.head in {*"pPnsoa"} and place and (place[1] or left.labelled) and (left.sup or left.before).isdigit():
        yield Target(f"T[{frame},{place[1] or n}]", (AXES[place[2]],), (_COLUMNS.get(left.head, 4),))


def _frames(left: Left, n: int, first: int) -> Iterator[str]:
    """Names of the transforms that the indices of a left side may mean."""
    # T_6^0 and {}^0T_6 are frame 6 in frame 0; two indices below, T_{06}, are reference and frame
    lower, upper = left.sub or left.before_sub, left.before or left.sup
    pair = re.fullmatch(r"([0-9A-Za-z]),?([0-9A-Za-z])", lower)
    if pair and not upper and lower not in _END and lower not in _BASE and not (lower.isdigit() and int(lower) <= n):
        lower, upper = pair[2], pair[1]
    chain = re.fullmatch(r"[1-9]{2,}", lower) if left.head in ("A", "T") and not upper else None
    if chain and lower in "123456789" and int(lower[-1]) <= n and len(lower) > 2:  # A_{234} = A_2 A_3 A_4
        yield f"T[{int(lower[0]) - 1},{lower[-1]}]"
        return
    if (not lower and upper in _TARGETS) or (lower == "d" and left.head in "RpPoOHT" and upper in ("", *_BASE)):
        lower, upper = "target", ""  # R^{des}, O_d^0
    lower = re.sub("^0(?:to|rightarrow)", "", lower) if upper in ("", *_BASE) else lower  # P_{0 \\to 3}
    if lower in (str(n + 1), *_END) and upper == str(n):
        yield "tool"
    if lower == str(n + 1) and upper.isdigit() and int(upper) < n:
        yield f"end[{int(upper)}]"
    wrists = ("w", "W", "wrist", "wc", "WC", *("cC" if left.head in "pPoO" else ""))
    if lower in wrists and upper in ("", *_BASE) and n > 3:
        yield from (f"T[{k}]" for k in (n - 2, n - 1))
        yield from (f"T[{n - 3},{n}]",) if left.head == "R" else ()  # what the last three joints turn
    if lower == "0" and upper in _BASE and upper != "0":
        yield "base"
    frame, reference = _frame(lower, n, first), _frame(upper, n, first)
    if lower == "0" and not upper and left.head in ("z", "p", "o", "O"):
        yield "T[0]"
    if frame is None or reference is None or (lower and frame == reference):
        return
    if lower == "" and upper in ("", *_BASE):
        yield "T"
    elif upper == "":
        yield from (f"A[{frame}]",) if left.head == "A" and frame else ()
        yield from ("T",) if lower in _END else ()
        yield from (f"T[0,{frame}]", f"T[{frame}]")
        yield from (f"A[{frame}]",) if frame else ()
        yield from ("T",) if frame == n else ()
    elif lower:
        yield from (f"A[{frame}]",) if left.head == "A" and frame == reference + 1 else ()
        if reference == 0 and frame == n:
            whole = ("T", f"T[0,{n}]") if lower in _END else (f"T[0,{n}]", "T")
            yield from (*whole, "end[0]") if lower == "tool" else whole
            yield f"T[{n}]"
        else:
            yield f"T[{reference},{frame}]"
            yield from (f"T[{frame}]",) if reference == 0 else ()
        if reference == 0:
            yield from (f"A[{frame}]",) if left.head == "A" else ()  # a step whatever stands above it


def _frame(text: str, n: int, first: int) -> int | None:
    """The number of a frame, from 0; None where it is none."""
    if text == "" or (text in _BASE and not (text == "0" and first != 1)):
        return 0
    if text in _END:
        return n
    index = int(text) - first + 1 if text.isdigit() and text.isascii() else -1
    return index if 0 <= index <= n else None


def _indices(text: str, largest: int) -> Indices:
    """Indices side by side or separated by commas, each from 1 to a largest one; none where it is something else."""
    parts = [part for part in re.split(r"[,;]", text) if part]
    if not all(part.isascii() and part.isdigit() for part in parts):
        return ()
    # a number of one index stays whole where commas part it from others, or where it is too large for a digit
    wholes = [int(part) <= largest and (len(parts) > 1 or int(part) > 9) for part in parts]
    digits = (digit for part, whole in zip(parts, wholes, strict=True) for digit in ([part] if whole else part))
    found = tuple(map(int, digits))
    return found if all(1 <= index <= largest for index in found) else ()
