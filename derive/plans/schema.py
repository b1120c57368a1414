"""Structure of a motion plan: which keys, which shapes; see `derive.robot.reading.schema`, which robot files follow."""

from typing import Annotated, Any, Literal

from derive.robot.reading.schema import FORMS, Cell, RobotFile, Vector3
from derive.robot.reading.structure import Discriminator, Field, Strict, Tag, WithJsonSchema, schema_of, usually

ProfileName = Literal["cubic", "quintic", "septic", "trapezoidal", "harmonic", "spline", "fastest"]
Via = Literal["stop", "pass"]
Splined = Literal["joints", "hand"]
Law = Literal["none", "pd", "pd-gravity", "computed-torque"]
FrictionKind = Literal["none", "smooth", "exact"]

Flag = Annotated[
    Literal["yes", "no", "true", "false"], WithJsonSchema({"enum": ["yes", "no", "true", "false", True, False]})
]

_TEXT, _LIST, _BLOCK = FORMS


class PoseRow(Strict):
    """A pose of the end effector in the world frame."""

    p: Vector3 = Field(description="Position, in the lengths of the robot file.")
    rpy: Vector3 | None = usually(None, "Roll, pitch, yaw: R = Rz(yaw) Ry(pitch) Rx(roll).")
    zyz: Vector3 | None = usually(None, "Euler angles: R = Rz(phi) Ry(theta) Rz(psi).")


class PosePoint(Strict):
    """A point that is a pose, reached through the inverse kinematics."""

    pose: PoseRow = Field(description="Where the end effector shall be.")
    branch: str | None = usually(None, "Name of the solution, or some of its words; default: the nearest.")
    end: str | None = usually(None, "Which end of a tree shall be there; its other joints stay.")


class Payload(Strict):
    """A body that the tool carries."""

    mass: Cell = Field(description="Mass [kg].")
    com: Vector3 = usually(("0", "0", "0"), "Centre of mass in the frame of the end effector.")
    inertia: Vector3 = usually(("0", "0", "0"), "Moments about it, along its axes [kg m^2].")
    end: str | None = usually(None, "Which end of a tree carries it.")


def _form(value: Any) -> str:
    return _TEXT if isinstance(value, str) else _LIST if isinstance(value, list) else _BLOCK


Gains = Annotated[Annotated[Cell, Tag(_TEXT)] | Annotated[list[Cell], Tag(_LIST)], Discriminator(_form)]
GivenRobot = Annotated[Annotated[str, Tag(_TEXT)] | Annotated[RobotFile, Tag(_BLOCK)], Discriminator(_form)]
GivenPoint = Annotated[Annotated[list[Cell], Tag(_LIST)] | Annotated[PosePoint, Tag(_BLOCK)], Discriminator(_form)]
Carried = Annotated[Annotated[Cell, Tag(_TEXT)] | Annotated[Payload, Tag(_BLOCK)], Discriminator(_form)]


class StepRow(Strict):
    """One segment of the path."""

    to: str = Field(description="Name of a point.")
    time: Cell | None = usually(None, "How long it takes [s]; default: what the limits allow.")
    profile: ProfileName | None = usually(None, "Of this segment alone.")
    via: Via | None = usually(None, "Whether the arm stops at its end.")
    cruise: Cell | None = usually(None, "Trapezoid: top speed as a multiple of distance by time.")
    line: Flag | None = usually(None, "The end effector moves on a straight line.")
    through: str | None = usually(None, "The end effector moves on an arc through this point.")
    payload: Carried | None = usually(None, "What the tool carries in this segment: a mass, or a body.")
    end: str | None = usually(None, "Which end of a tree moves on the line or arc, and carries that.")


class Control(Strict):
    """Who moves the arm in a simulation."""

    law: Law = Field(description="The law.")
    kp: Gains = usually("0", "Gain of the position, one or one a joint.")
    kd: Gains = usually("0", "Gain of the velocity, one or one a joint.")
    period: Cell | None = usually(None, "Time between two samples of the controller [s].")


class BaseRow(Strict):
    """Where the base of the robot file stands in the world, by formulas of t."""

    x: Cell = usually("0", "In the lengths of the robot file.")
    y: Cell = usually("0", "Likewise.")
    z: Cell = usually("0", "Likewise.")
    rpy: Vector3 = usually(("0", "0", "0"), "Roll, pitch, yaw: R = Rz(yaw) Ry(pitch) Rx(roll).")


class DisturbanceRow(Strict):
    """What pushes a joint for a time, in a simulation."""

    joint: str = Field(description="Joint variable.")
    torque: Cell = Field(description="Torque or force [N m or N].")
    start: Cell = usually("0", "When it begins [s].")
    end: Cell = Field(description="When it ends [s].")


class PlanFile(Strict):
    """A motion: the robot, its points and the way between them."""

    robot: GivenRobot = Field(description="A built-in name, the path of a robot file, or the robot itself.")
    title: str | None = usually(None, "Free text for people.")
    profile: ProfileName = usually("quintic", "How the arm goes from point to point.")
    via: Via = usually("stop", "Whether the arm stops at the points between.")
    spline: Splined = usually(
        "joints", "With profile spline: what moves on it, the joint variables or the end effector."
    )
    sample: Cell = usually("0.01", "Time between two rows of a table of the motion [s].")
    speed: list[Cell] | None = usually(
        None, "Largest speed of each joint, where no time is given; default: that of the robot file."
    )
    acceleration: list[Cell] | None = usually(None, "Largest acceleration of each joint.")
    torque: list[Cell] | None = usually(
        None, "Largest torque or force of each joint in the fastest motion; default: that of the robot file."
    )
    values: dict[str, Cell] = usually({}, "Numbers of symbols of the robot that have none.")
    points: dict[str, GivenPoint] = usually({}, "Joint values or poses, by name.")
    path: list[Annotated[Annotated[str, Tag(_TEXT)] | Annotated[StepRow, Tag(_BLOCK)], Discriminator(_form)]] = usually(
        [], "Points one after the other."
    )
    curves: dict[str, Cell] = usually({}, "Instead of a path: each joint variable as a formula of t.")
    time: Cell | None = usually(None, "How long curves last [s].")
    recorded: str | None = usually(None, "Instead: a CSV file with columns t and joint variables.")
    base: BaseRow | None = usually(None, "How the base moves, by formulas of t.")
    control: Control | None = usually(None, "Who moves the arm in a simulation.")
    plant: dict[str, Carried] = usually(
        {}, "The simulated arm, where it differs: numbers of symbols, and payload: a body."
    )
    disturbance: list[DisturbanceRow] = usually([], "What pushes joints in a simulation.")
    friction: FrictionKind = usually("smooth", "How Coulomb friction is simulated.")


def plan_json_schema() -> dict[str, Any]:
    """JSON Schema of a motion plan, for editors."""
    schema = "https://json-schema.org/draft/2020-12/schema"
    return {"$schema": schema, **schema_of(PlanFile), "title": "derive motion plan"}
