"""Wrong plans, and how the message about each begins."""

RIGHT = """\
robot: {name: arm, convention: standard, inverse: {task: [x, y]}, gravity: [0, -9.81, 0], links: [{mass: 1}, {mass: 1}],
  joints: [{type: revolute, a: 1, limits: [-3, 3], speed: 5, torque: 50}, {type: revolute, a: 0.5}]}
points:
  a: [0, 1]
  b: [1, 2]
path: [a, {to: b, time: 1}]
"""
"""A plan that is right."""

BY_WHAT_IS_REPLACED: dict[str, dict[str, str]] = {
    "b: [1, 2]": {
        "b: 3": "5:6: points, b: found the text '3'; allowed: a list or a mapping with the keys pose,",
        "b:": "5:5: points, b: found nothing; allowed: a list or a mapping with the keys pose, branch, end",
        "b: [[1], 2]": "5:7: points, b entry 1: found a list; allowed: one number, name or expression; check the",
        "b: [yes, 2]": "5:7: points, b entry 1: the symbol 'yes' has no number; write values: {yes: ...}",
        "b: [nan, 2]": "5:7: points, b entry 1: 'nan' is not a number; write a finite number or another name",
        "b: [1, 1e400]": "5:10: points, b entry 2: decimal exponent too large; at most 99",
        "b: [1, 1/0]": "5:11: points, b entry 2: division by zero in '1/0'; remove it",
        "b: [1, sqrt(-1)]": "5:10: points, b entry 2: root of a negative number; allowed: a finite real value",
        "b: [1, __import__('os')]": "5:10: points, b entry 2: unexpected character '_' in '__import__('os')'; allowed:",
        "b: [1, q1]": "5:10: points, b entry 2: the symbol 'q1' has no number; write values: {q1: ...}",
        "b: [4, 2]": "5:7: points, b entry 1: q1 = 4 rad is outside its limits; allowed: -3 to 3 rad",
        "b: {pose: {p: [2, 0, 0]}}": "5:3: the arm does not reach b: q2 is real for Abs(D) <= 1, which are 2.75 and 1",
        "b: {pose: {rpy: [1, 0, 1]}}": "5:13: points, b, pose: key 'p' is missing; add it",
        "b: {pose: {p: [1, 0]}}": "5:17: points, b, pose, p: 2 entries; allowed: exactly 3; write zeros where nothing",
        "b: {pose: {p: [1, 0, 0], rpy: [0, 0, 0], zyz: [0, 0, 0]}}": "5:13: points, b, pose: both rpy and zyz",
        "b: {pose: {p: [1, 0, 0]}, branch: elbow-upp}": "5:3: point b: no branch 'elbow-upp' of arm; allowed: elbow",
        "b: {pose: 1}": "5:13: points, b, pose: found the text '1'; allowed: a mapping with the keys p, rpy, zyz",
        "b: {}": "5:6: points, b: key 'pose' is missing; add it",
        "b: {pose: {p: [1, 0, 0], rpy: [0, 0, 0]}}": "5:33: points, b, pose, rpy: an orientation, and the task of arm",
    },
    "path: [a, {to: b, time: 1}]": {
        "path: []": "1:1: the plan: neither path nor curves nor recorded; allowed: one of them; write path:",
        "path: [a]": "6:7: path: one point; allowed: two or more; write path: [rest, {to: A, time: 3}]",
        "path: a": "6:7: path: found the text 'a'; allowed: a list; check the indentation and the dashes",
        "path: {a: b}": "6:7: path: found a mapping; allowed: a list; check the indentation; texts with ': ' or '{'",
        "curves: {q1: t}\ntime: 1": "4:3: points: points beside curves, and there is no path; leave points out",
    },
    "path: [a,": {"path: [1,": "6:8: path entry 1: unknown point '1'; allowed: a, b"},
    "{to: b, time: 1}": {
        "{time: 1}": "6:11: path entry 2: key 'to' is missing; add it",
        "{to: , time: 1}": "6:15: path entry 2, to: found nothing; allowed: a, b",
        "{to: b, tme: 1}": "6:19: path entry 2: unknown key 'tme'; allowed: to, time, profile, via, cruise, line,",
        "{to: b, time: 1, profile: trapezoidal, via: pass}, {to: a, time: 1, profile: trapezoidal}": "6:11: a "
        "trapezoidal motion stops at its points, and b is passed; write via: stop, or a",
        "{to: b, time: 1, via: pass}, {to: a, time: 1, profile: cubic}": "6:33: path entry 2, via: b is not passed:",
    },
    "[a,": {"[{to: a, time: 3},": "6:22: path entry 1, time: time at the start of the path; allowed: a point; write a"},
    "time: 1": {
        "time: [1]": "6:25: path entry 2, time: found a list; allowed: one number, name or expression; check the",
        "time: 0": "6:25: path entry 2, time: found '0'; allowed: a time above zero [s]",
        "time: 1e7": "6:7: 1e+09 samples of 1e+07 s, 72 GB; allowed: at most 1000000 samples; write sample: 1e+04",
        "time: 3s": "6:26: path entry 2, time: no operator before 's' in '3s'; write 3: numbers are in SI units",
        "time: 1, payload: -1": "6:37: path entry 2, payload: found '-1'; allowed: zero or more [kg]",
        "time: 1, payload: [1, 2]": "6:37: path entry 2, payload: found a list; allowed: one number, name or",
        "time: 1, payload: {com: [0, 0, 0]}": "6:37: path entry 2, payload: key 'mass' is missing; add it",
        "time: 1, payload: {mass: 1, inertia: [-1, 0, 0]}": "6:57: path entry 2, payload, inertia entry 1: found '-1'",
        "time: 1, line: maybe": "6:34: path entry 2, line: found 'maybe'; allowed: 'yes', 'no', 'true' or 'false'",
        "time: 1, through: zz": "6:37: path entry 2, through: unknown point 'zz'; allowed: a, b",
        "time: 1, line: yes, through: a": "6:48: path entry 2, through: both line and through; allowed: one of the",
        "time: 1, through: a": "6:11: the three positions lie on one line; write line: yes",
        "time: 1, profile: trapezoidal, cruise: 3": "6:11: cruise 3 of the trapezoid to b; allowed: above 1, and 2 at",
        "time: 1, cruise: 1.5": "6:36: path entry 2, cruise: a cruise of a quintic motion; allowed: of a trapezoid",
        "time: 1, via: through": "6:33: path entry 2, via: found 'through'; allowed: 'stop' or 'pass'",
        "time: 1, via: pass": "6:33: path entry 2, via: b is not passed: the arm stops where the path ends; leave",
    },
    "": {
        "sample: 0\n": "7:9: sample: found '0'; allowed: a time above zero [s]",
        "sample: 1e-9\n": "7:9: 1e+09 samples of 1 s, 72 GB; allowed: at most 1000000 samples; write sample: 0.001 [s]",
        "speed: [1]\n": "7:8: speed: 1 value for 2 joints; allowed: one for each of q1, q2",
        "speed: [0, 1]\n": "7:9: speed entry 1: not above zero; allowed: a positive number",
        "acceleration: [w, 1]\n": "7:16: acceleration entry 1: the symbol 'w' has no number; write values: {w: ...}",
        "control: {law: pd, kp: -1}\n": "7:24: control, kp: found '-1'; allowed: zero or more; a gain below zero",
        "control: {law: pd, kp: [1, 2, 3]}\n": "7:24: control, kp: 3 gains for 2 joints; allowed: one, or 2",
        "control: {law: pid}\n": "7:16: control, law: found 'pid'; allowed: 'none', 'pd', 'pd-gravity' or",
        "control: {kp: 1}\n": "7:10: control: key 'law' is missing; add it",
        "control: pd\n": "7:10: control: found the text 'pd'; allowed: a mapping with the keys law, kp, kd, period",
        "control: {law: pd, kp: 1, period: 0}\n": "7:35: control, period: found '0'; allowed: a time above zero [s]",
        "friction: Smooth\n": "7:11: friction: found 'Smooth'; allowed: 'none', 'smooth' or 'exact'; did you mean",
        "plant: {zz: 1}\n": "7:13: plant, zz: no symbol 'zz' in arm; allowed: payload",
        "plant: [1]\n": "7:8: plant: found a list; allowed: a mapping; check the indentation and the dashes",
        "disturbance: [{joint: q9, torque: 1, end: 1}]\n": "7:23: disturbance entry 1, joint: no joint 'q9'; allowed:",
        "disturbance: [{joint: q1, torque: 1}]\n": "7:15: disturbance entry 1: key 'end' is missing; add it",
        "disturbance: [{joint: q1, torque: 1, start: 2, end: 1}]\n": "7:53: disturbance entry 1, end: from 2 to 1 s",
        "values: {zz: 1}\n": "7:14: values, zz: no symbol 'zz' in arm or in a formula; remove it",
        "values: {x: y, y: x}\n": "7:13: values, x: the symbol 'y' has no number; write values: {y: ...}",
        "values: {'a b': 1}\n": "7:17: values, a b: 'a b' is not a name; allowed: a letter A-Z or a-z, then letters,",
        "values: {q1: 1}\n": "7:14: values, q1: q1 is a joint variable; allowed: symbols of the robot and of formulas",
        "curves: {q1: t}\ntime: 1\n": "7:9: curves: both path and curves; allowed: one of them; write path: [rest,",
        "base: {x: w*t}\n": "7:11: base, x: the symbol 'w' has no number; write values: {w: ...}",
        "time: 3\n": "7:7: time: a time beside path; allowed: beside curves; write the time of each segment: {to:",
        "title: [1]\n": "7:8: title: found a list; allowed: a text; check the indentation and the dashes",
        "pünkte: {}\n": "7:1: the plan: unknown key 'pünkte'; allowed: robot, title,",
        "recorded: x.csv\n": "7:11: recorded: both path and recorded; allowed: one of them; write path: [rest, {to: A,",
        "spline: joints\n": "7:9: spline: joints, and no profile is spline; write profile: spline, or leave spline:",
        "control: {law: none, kp: 3}\n": "7:26: control, kp: kp of no control law; name another law, or leave it out",
        "control: {law: none, period: 0.1}\n": "7:30: control, period: period of no control law; name another law",
        "disturbance: [{joint: q1, torque: 1, start: 1, end: 2}]\n": "7:15: a disturbance from 1 s on, and the motion",
        "control: {law: pd, kp: 1, period: 1e-9}\n": "7:35: control, period: 1e+09 samples of the controller in 1 s",
    },
    "{to: b, time: 1}]": {
        "{to: b, time: 1}, {to: a, time: 1, line: yes}]\nvia: pass": "7:6: via: b is not passed: the arm stops between",
    },
}
"""What is replaced in it (nothing: what follows it), by what, and the message from the line on."""

WRONG = [(old, new, said) for old, cases in BY_WHAT_IS_REPLACED.items() for new, said in cases.items()]
