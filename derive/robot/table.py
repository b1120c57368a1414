"""The blocks of a robot file that say what the arm is: its Denavit-Hartenberg table, frames, links and gravity."""

from collections.abc import Callable, Iterable, Mapping

from derive.errors import listed, quoted
from derive.robot import expression as tree
from derive.robot.cells import Cells, inert_text, length_in_metres
from derive.robot.description import IDENTITY, INERTIA, Inertia, Joint, JointType, Link, Matrix, Motor, Vector
from derive.robot.evaluate import evaluate
from derive.robot.expression import ONE, ZERO, Expression, Name, Product, is_constant, names, to_text
from derive.robot.reading.document import Document, KeyPath

# The symbol of gravity where a file with links does not say: it points along -z of the world frame.
DEFAULT_GRAVITY_SYMBOL = "g"
# Entries of R^T R - 1: decimals with seven places pass, 0.7071 does not, and should be sqrt(2)/2.
ROTATION_TOLERANCE = 1e-6
MOUNT_TOLERANCE = 1e-12  # the same of a mount: what stands between joints must turn bodies without stretching them
Read = Callable[[KeyPath], Expression]  # reads the cell at a place in its unit
_SUM = "a sum of variables with constant factors, and a constant"  # what a cell that moves may be


class MovingRow:
    """A row of the table that moves, whatever it follows: which cell moves, its sign, and the constant rest."""

    def __init__(self, document: Document, cells: Cells, row: int, variable: str, variables: frozenset[str]) -> None:
        self._document, self._cells = document, cells
        self._variables, self._variable = variables, variable
        self._path: KeyPath = ("joints", row)
        self._type = JointType(document.text(*self._path, "type"))
        self._moving, self._fixed = ("theta", "d") if self._type is JointType.REVOLUTE else ("d", "theta")

    def read(self) -> Joint:
        """The row."""
        raw: dict[str, Expression] = {}
        for key in ("a", "alpha", self._fixed):
            raw[key] = self._cells.raw((*self._path, key))
            self._refuse_variables(key, raw[key])
        sign, raw[self._moving], drive = self._moving_cell()
        read = self._cells.angle if self._type is JointType.REVOLUTE else self._cells.length
        return Joint(
            type=self._type,
            variable=self._variable,
            sign=sign,
            theta=self._cells.to_radians((*self._path, "theta"), raw["theta"]),
            d=length_in_metres(raw["d"], self._cells.units),
            a=length_in_metres(raw["a"], self._cells.units),
            alpha=self._cells.to_radians((*self._path, "alpha"), raw["alpha"]),
            limits=read_limits(self._document, self._cells, self._path, read, self._variables),
            speed=read_bound(self._document, self._cells, self._path, "speed", read),
            torque=read_bound(self._document, self._cells, self._path, "torque", self._cells.plain),
            drive=drive,
            name="" if (name := inert_text(self._document, (*self._path, "name"))) == self._variable else name,
        )

    def _refuse_variables(self, key: str, expression: Expression) -> None:
        name = next((name for name in names(expression) if name in self._variables), None)
        if name is None:
            return
        remedy = "use another name"
        if name == self._variable and key == self._fixed:
            other = "prismatic" if self._type is JointType.REVOLUTE else "revolute"
            remedy = f"write type: {other}, or move {name} to {self._moving}"
        found = f"joint variable '{name}' in the cell {key} of a {self._type.value} joint"
        raise self._document.error((*self._path, key), found, f"allowed: only in the cell {self._moving}", remedy)

    def _moving_cell(self) -> tuple[int, Expression, tuple[tuple[str, Expression], ...]]:
        """Sign of the variable and constant rest of the cell that moves, before units; of a coupled joint its drive."""
        own, path = Name(self._variable), (*self._path, self._moving)
        expression = self._cells.raw(path, own)
        factors: dict[str, list[Expression]] = {}  # cell = sum of factors * variables + rest
        rest: list[Expression] = []
        for factor, term in tree.linear_terms(expression):
            moved = [name for name in names(term) if name in self._variables]
            parts = term.factors if isinstance(term, Product) else (term,)
            others = [part for part in parts if part != Name(*moved[:1] or [""])]
            if not moved:
                rest.append(tree.multiply(tree.number(factor), term))
            elif len(moved) == 1 and len(others) < len(parts):
                factors.setdefault(moved[0], []).append(tree.multiply(tree.number(factor), *others))
            else:
                found = f"{quoted(to_text(expression))} is not linear in {listed(dict.fromkeys(moved))}"
                raise self._document.error(path, found, f"allowed: {_SUM}", "multiply it out")
        drive = tuple((name, total) for name, own in factors.items() if (total := tree.add(*own)) != ZERO)
        if not drive:
            name, is_own = self._variable, self._variable in self._variables
            other = next((other for other in names(expression) if other not in self._variables), None)
            hint = f"; if '{other}' is the variable, write q: {other}" if other else ""
            what = f"{self._moving} is the cell that moves in a {self._type.value} joint"
            how = f"leave the cell out or write {self._moving}: {name} + ..." if is_own else "write what moves the row"
            said = f"{quoted(to_text(expression))} is constant, but {what}"
            allowed = f"allowed: {f'{name} or -{name}, with a constant added, or ' * is_own}{_SUM}"
            raise self._document.error(path, said, allowed, f"{how}; a figure's position is no part of the table{hint}")
        if [name for name, _ in drive] == [self._variable] and drive[0][1] in (ONE, tree.negate(ONE)):
            return 1 if drive[0][1] == ONE else -1, tree.add(*rest), ()
        return 1, tree.add(*rest), drive


def read_limits(
    document: Document, cells: Cells, path: KeyPath, read: Read, variables: frozenset[str] = frozenset()
) -> tuple[Expression, Expression] | None:
    """Lower and upper limit of a joint or a variable."""
    path = (*path, "limits")
    if document.find(path) is None:
        return None
    lower, upper = read((*path, 0)), read((*path, 1))
    for name in (*names(lower), *names(upper)):
        if name in variables:
            raise document.error(path, f"joint variable '{name}' in limits", "allowed: numbers and parameters")
    return lower, upper


def read_bound(document: Document, cells: Cells, path: KeyPath, key: str, read: Read) -> Expression | None:
    """The largest magnitude of something, a positive number."""
    path, allowed = (*path, key), "allowed: a number above zero"
    if document.find(path) is None:
        return None
    value = cells.constant(path, read(path), f"the largest {key}", allowed)
    try:
        positive = evaluate(value, {}) > 0
    except ArithmeticError as error:
        raise document.error(path, str(error), allowed) from None
    if not positive:
        raise document.error(path, f"found {quoted(document.text(*path))}", allowed)
    return value


def read_frame(document: Document, cells: Cells, path: KeyPath) -> Matrix:
    """A constant transform, which changes nothing where there is none."""
    if document.find(path) is None:
        return IDENTITY
    rows = tuple(
        tuple((cells.length if j == 3 and i < 3 else cells.plain)((*path, i, j)) for j in range(4)) for i in range(4)
    )
    if rows[3] != (ZERO, ZERO, ZERO, ONE):
        remedy = "write the translation into the last column"
        raise document.error((*path, 3), "bottom row is not 0, 0, 0, 1", remedy=remedy)
    return rows


def check_rotation(document: Document, path: KeyPath, matrix: Matrix, trials: Iterable[Mapping[str, float]]) -> None:
    """Refuse a rotation block that is not a rotation at the given parameter values."""
    tolerance, blocks = MOUNT_TOLERANCE if path[-1] == "mount" else ROTATION_TOLERANCE, []
    for values in trials:
        try:
            blocks.append([[evaluate(entry, values) for entry in row[:3]] for row in matrix[:3]])
        except ArithmeticError:
            continue
    if not blocks:
        raise document.error(path, "the rotation block has no real value", "allowed: a rotation")
    remedy = "write angles exactly: cos(pi/4), sqrt(2)/2"
    if not all(is_constant(entry) for row in matrix[:3] for entry in row[:3]):
        remedy = "it must be a rotation for all values of its names: write cos(beta) and sin(beta)"
    for m in blocks:
        for i, j in ((0, 0), (1, 0), (1, 1), (2, 0), (2, 1), (2, 2)):
            product = sum(x * y for x, y in zip(m[i], m[j], strict=True))
            if abs(product - (i == j)) > tolerance:
                found = f"rows {j + 1} and {i + 1} of the rotation block have the scalar product {product:.3g}"
                if i == j:
                    found = f"row {i + 1} of the rotation block has length {product**0.5:.9g}"
                raise document.error((*path, i), found, f"allowed: a rotation to within {tolerance:g}", remedy)
        # orthogonal with determinant -1: a reflection, that is a left-handed frame
        cycles = ((0, 1, 2), (1, 2, 0), (2, 0, 1))
        if sum(m[0][i] * (m[1][j] * m[2][k] - m[1][k] * m[2][j]) for i, j, k in cycles) < 0:
            found = "reflection: the rotation block has determinant -1"
            raise document.error(path, found, remedy="change the sign of one column")


def read_link(document: Document, cells: Cells, path: KeyPath) -> Link:
    """Inertial parameters, motor and friction of a body."""
    mass = cells.plain((*path, "mass"))
    x, y, z = (cells.length((*path, "com", index)) for index in range(3))
    inertia = Inertia(**{key: cells.plain((*path, "inertia", key)) for key in INERTIA})
    motor = None
    if document.find((*path, "motor")) is not None:
        motor = Motor(**{key: cells.plain((*path, "motor", key)) for key in ("mass", "inertia", "ratio")})
    armature = cells.plain((*path, "armature"))
    viscous, dry = cells.plain((*path, "friction", "viscous")), (*path, "friction", "coulomb")
    ways = cells.plain((*dry, 0)), cells.plain((*dry, 1))
    coulomb = ways if ways != (ZERO, ZERO) else cells.plain(dry)
    return Link(mass, (x, y, z), inertia, motor, armature, viscous, coulomb)


def read_gravity(document: Document, cells: Cells) -> Vector | None:
    """Acceleration of gravity in the world frame [m/s^2]; None where there are neither gravity nor links."""
    # A file with links and without gravity means [0, 0, -g]: z points up, and g is a symbol like any other. It is read
    # after everything else, because that default is refused where g means something else.
    if document.find(("gravity",)) is not None:
        x, y, z = (cells.plain(("gravity", index)) for index in range(3))
        return x, y, z
    if document.find(("links",)) is None:
        return None
    if DEFAULT_GRAVITY_SYMBOL in cells.first_use:
        found = "links without gravity, and the name 'g' is used for something else"
        remedy = "write the vector, for instance gravity: [0, 0, -9.81]"
        raise document.error(("links",), found, "allowed: gravity: [gx, gy, gz]", remedy)
    cells.first_use[DEFAULT_GRAVITY_SYMBOL] = document.location(("links",))
    return ZERO, ZERO, tree.negate(Name(DEFAULT_GRAVITY_SYMBOL))
