"""Structure of a motion plan: which keys, which shapes; see `derive.robot.reading.schema`, which robot files follow."""

from typing import Annotated, Any, Literal

from derive.robot.reading.json_schema import without_null
from derive.robot.reading.schema import FORMS, Cell, RobotFile, Vector3
from derive.robot.reading.structure import Discriminator, Field, Strict, Tag, WithJsonSchema, model_of

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
    rpy: Vector3 | None = Field(default=None, description="Roll, pitch, yaw: R = Rz(yaw) Ry(pitch) Rx(roll).")
    zyz: Vector3 | None = Field(default=None, description="Euler angles: R = Rz(phi) Ry(theta) Rz(psi).")


class PosePoint(Strict):
    """A point that is a pose, reached through the inverse kinematics."""

    pose: PoseRow = Field(description="Where the end effector shall be.")
    branch: str | None = Field(
        default=None, description="Name of the solution, or some of its words; default: the nearest."
    )
    end: str | None = Field(default=None, description="Which end of a tree shall be there; its other joints stay.")


class Payload(Strict):
    """A body that the tool carries."""

    mass: Cell = Field(description="Mass [kg].")
    com: Vector3 = Field(default=("0", "0", "0"), description="Centre of mass in the frame of the end effector.")
    inertia: Vector3 = Field(default=("0", "0", "0"), description="Moments about it, along its axes [kg m^2].")
    end: str | None = Field(default=None, description="Which end of a tree carries it.")


def _form(value: Any) -> str:
    return _TEXT if isinstance(value, str) else _LIST if isinstance(value, list) else _BLOCK


Gains = Annotated[Annotated[Cell, Tag(_TEXT)] | Annotated[list[Cell], Tag(_LIST)], Discriminator(_form)]
GivenRobot = Annotated[Annotated[str, Tag(_TEXT)] | Annotated[RobotFile, Tag(_BLOCK)], Discriminator(_form)]
GivenPoint = Annotated[Annotated[list[Cell], Tag(_LIST)] | Annotated[PosePoint, Tag(_BLOCK)], Discriminator(_form)]
Carried = Annotated[Annotated[Cell, Tag(_TEXT)] | Annotated[Payload, Tag(_BLOCK)], Discriminator(_form)]


class StepRow(Strict):
    """One segment of the path."""

    to: str = Field(description="Name of a point.")
    time: Cell | None = Field(default=None, description="How long it takes [s]; default: what the limits allow.")
    profile: ProfileName | None = Field(default=None, description="Of this segment alone.")
    via: Via | None = Field(default=None, description="Whether the arm stops at its end.")
    cruise: Cell | None = Field(default=None, description="Trapezoid: top speed as a multiple of distance by time.")
    line: Flag | None = Field(default=None, description="The end effector moves on a straight line.")
    through: str | None = Field(default=None, description="The end effector moves on an arc through this point.")
    payload: Carried | None = Field(
        default=None, description="What the tool carries in this segment: a mass, or a body."
    )
    end: str | None = Field(default=None, description="Which end of a tree moves on the line or arc, and carries that.")


class Control(Strict):
    """Who moves the arm in a simulation."""

    law: Law = Field(description="The law.")
    kp: Gains = Field(default="0", description="Gain of the position, one or one a joint.")
    kd: Gains = Field(default="0", description="Gain of the velocity, one or one a joint.")
    period: Cell | None = Field(default=None, description="Time between two samples of the controller [s].")


class BaseRow(Strict):
    """Where the base of the robot file stands in the world, by formulas of t."""

    x: Cell = Field(default="0", description="In the lengths of the robot file.")
    y: Cell = Field(default="0", description="Likewise.")
    z: Cell = Field(default="0", description="Likewise.")
    rpy: Vector3 = Field(default=("0", "0", "0"), description="Roll, pitch, yaw: R = Rz(yaw) Ry(pitch) Rx(roll).")


class DisturbanceRow(Strict):
    """What pushes a joint for a time, in a simulation."""

    joint: str = Field(description="Joint variable.")
    torque: Cell = Field(description="Torque or force [N m or N].")
    start: Cell = Field(default="0", description="When it begins [s].")
    end: Cell = Field(description="When it ends [s].")


class PlanFile(Strict):
    """A motion: the robot, its points and the way between them."""

    robot: GivenRobot = Field(description="A built-in name, the path of a robot file, or the robot itself.")
    title: str | None = Field(default=None, description="Free text for people.")
    profile: ProfileName = Field(default="quintic", description="How the arm goes from point to point.")
    via: Via = Field(default="stop", description="Whether the arm stops at the points between.")
    spline: Splined = Field(
        default="joints", description="With profile spline: what moves on it, the joint variables or the end effector."
    )
    sample: Cell = Field(default="0.01", description="Time between two rows of a table of the motion [s].")
    speed: list[Cell] | None = Field(
        default=None,
        description="Largest speed of each joint, where no time is given; default: that of the robot file.",
    )
    acceleration: list[Cell] | None = Field(default=None, description="Largest acceleration of each joint.")
    torque: list[Cell] | None = Field(
        default=None,
        description="Largest torque or force of each joint in the fastest motion; default: that of the robot file.",
    )
    values: dict[str, Cell] = Field(default={}, description="Numbers of symbols of the robot that have none.")
    points: dict[str, GivenPoint] = Field(default={}, description="Joint values or poses, by name.")
    path: list[Annotated[Annotated[str, Tag(_TEXT)] | Annotated[StepRow, Tag(_BLOCK)], Discriminator(_form)]] = Field(
        default=[], description="Points one after the other."
    )
    curves: dict[str, Cell] = Field(default={}, description="Instead of a path: each joint variable as a formula of t.")
    time: Cell | None = Field(default=None, description="How long curves last [s].")
    recorded: str | None = Field(default=None, description="Instead: a CSV file with columns t and joint variables.")
    base: BaseRow | None = Field(default=None, description="How the base moves, by formulas of t.")
    control: Control | None = Field(default=None, description="Who moves the arm in a simulation.")
    plant: dict[str, Carried] = Field(
        default={}, description="The simulated arm, where it differs: numbers of symbols, and payload: a body."
    )
    disturbance: list[DisturbanceRow] = Field(default=[], description="What pushes joints in a simulation.")
    friction: FrictionKind = Field(default="smooth", description="How Coulomb friction is simulated.")


def plan_json_schema() -> dict[str, Any]:
    """JSON Schema of a motion plan, for editors."""
    plan = without_null(model_of(PlanFile).model_json_schema(ref_template="#/$defs/{model}"))
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **plan, "title": "derive motion plan"}
