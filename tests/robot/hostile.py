"""Broken and hostile robot files: name, bytes, and words that the refusal must contain.

Every file must be refused quickly, with one line that names the file and the line.
"""

GOOD = """\
name: r
title: t
convention: standard
joints:
  - {type: revolute, a: a1}
  - {type: prismatic, a: a2}
gravity: [0, 0, -g]
links:
  - {mass: m1, com: [0, 0, 0]}
  - {mass: m2, com: [0, 0, 0]}
parameters: {a1: 1, a2: 2}
runtime: [a1]
"""


def changed(old: str, new: str) -> bytes:
    assert GOOD.count(old) == 1, old
    return GOOD.replace(old, new).encode()


def cell(text: str) -> bytes:
    return changed("a: a1}", f"a: {text}, d: a1}}")


def with_tail(text: str) -> bytes:
    return (GOOD + text).encode()


FRAME = "tool: [[{}, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, {}]]\n"

HOSTILE: dict[str, tuple[bytes, str]] = {
    # code
    "import": (cell("\"__import__('os').system('touch /tmp/derive-was-here')\""), "unexpected character"),
    "eval": (cell('"eval(x)"'), "unknown function"),
    "template": (cell('"{{ 7*7 }}"'), "unexpected character"),
    "latex": (cell(r'"\\input{/etc/passwd}"'), "unexpected character"),
    "tag-object": (cell("!!python/object/apply:os.system ['true']"), "YAML tag"),
    "tag-local": (changed("name: r", "name: !x r"), "YAML tag"),
    # bombs
    "repeated-power": (cell("(((9**32)**32)**32)**32"), "too large"),
    "aliases": (b"a: &a [x, x]\nb: &b [*a, *a]\nc: &c [*b, *b]\nname: r\n", "anchor"),
    "alias-only": (cell("*x"), "alias"),
    "nested-lists": (b"[" * 100_000, "nested too deeply"),
    "nested-mappings": (b"{a: " * 50_000, "nested too deeply"),
    "ten-megabytes": (GOOD.encode() + b"# " + b"x" * 10_000_000, "larger than"),
    "many-values": (b"x: [" + b"1," * 100_000 + b"]\n", "more than"),
    "thousand-joints": (changed("  - {type: prismatic, a: a2}\n", "  - {type: revolute}\n" * 1_000), "rows"),
    "merge-key": (changed("runtime: [a1]", "<<: {runtime: [a1]}"), "merge"),
    # names
    "name-path": (changed("name: r", "name: ../../etc/passwd"), "not a robot name"),
    "name-empty": (changed("name: r", "name: ''"), "not a robot name"),
    "name-capital": (changed("name: r", "name: SCARA"), "scara"),
    "name-newline": (changed("name: r", 'name: "r\\nimport os"'), "not a robot name"),
    "name-long": (changed("name: r", "name: " + "r" * 300), "not a robot name"),
    "name-keyword": (changed("name: r", "name: class"), "Python package"),
    "name-shadow": (changed("name: r", "name: numpy"), "Python package"),
    "name-list": (changed("name: r", "name: [r]"), "found a list"),
    "symbol-greek": (cell("\u03b1"), "U+03B1"),
    "parameter-name": (changed("a2: 2}", "2a: 2, a2: 2}"), "is not a name"),
    "parameter-function": (changed("a2: 2}", "sin: 2, a2: 2}"), "cannot be a symbol"),
    "title-control": (changed("title: t", 'title: "\\e[31m"'), "control character"),
    "title-surrogate": (changed("title: t", 'title: "\\ud800"'), "control character"),
    "title-long": (changed("title: t", "title: " + "t" * 501), "501 characters"),
    "title-list": (changed("title: t", "title: [t]"), "found a list"),
    # typing errors
    "unknown-key": (changed("runtime: [a1]", "runtimes: [a1]"), "did you mean 'runtime'"),
    "unknown-cell": (cell("1, alfa: 0"), "did you mean 'alpha'"),
    "unknown-link-key": (changed("mass: m1, com", "mass: m1, cog"), "did you mean 'com'"),
    "unknown-inertia-key": (changed("{mass: m1,", "{inertia: {yx: 1}, mass: m1,"), "write xy"),
    "offset-habit": (cell("1, offset: pi"), "theta: q1"),
    "missing-convention": (changed("convention: standard\n", ""), "'convention' is missing"),
    "missing-name": (changed("name: r\n", ""), "'name' is missing"),
    "missing-type": (changed("type: prismatic, ", ""), "'type' is missing"),
    "missing-joints": (b"name: r\nconvention: standard\n", "'joints' is missing"),
    "wrong-convention": (changed("standard", "standart"), "did you mean 'standard'"),
    "wrong-type": (changed("prismatic", "prismatik"), "did you mean 'prismatic'"),
    "wrong-unit": (with_tail("units: {angle: degrees}\n"), "'rad' or 'deg'"),
    "unused-parameter": (changed("a2: 2}", "a2: 2, a3: 3}"), "no cell uses"),
    "unknown-runtime": (changed("[a1]", "[a9]"), "unknown symbol"),
    "wrench-name": (with_tail("wrench: world\n"), "write wrench: [world]"),
    "wrench-axes": (with_tail("wrench: [tool]\n"), "allowed: 'world' or 'end'"),
    "wrench-twice": (with_tail("wrench: [end, end]\n"), "twice"),
    "wrench-of-a-tree": (with_tail("wrench: [end]\nends: {e: q2}\n"), "one chain of joints"),
    "runtime-twice": (changed("[a1]", "[a1, a1]"), "twice"),
    "runtime-variable": (changed("[a1]", "[q1]"), "joint variable"),
    "parameter-variable": (changed("a2: 2}", "a2: 2, q1: 1}"), "joint variable"),
    "parameter-name-in-number": (changed("a2: 2}", "a2: 2*a1}"), "name 'a1'"),
    "variable-in-mass": (changed("mass: m1", "mass: m1*q1"), "joint variable"),
    "duplicate-key": (with_tail("name: s\n"), "twice"),
    "duplicate-cell": (cell("1, a: 2"), "twice"),
    "duplicate-parameter": (changed("a2: 2}", "a2: 2, a2: 3}"), "twice"),
    "robot-and-joints": (with_tail("robot: {name: s}\n"), "beside the block"),
    "robot-is-text": (b"robot: scara\n", "not a mapping"),
    # shapes
    "joints-mapping": (b"name: r\nconvention: standard\njoints: {type: revolute}\n", "allowed: a list"),
    "joints-empty": (b"name: r\nconvention: standard\njoints: []\n", "0 rows"),
    "joint-text": (b"name: r\nconvention: standard\njoints: [revolute]\n", "a mapping"),
    "cell-list": (cell("[1]"), "found a list"),
    "cell-mapping": (cell("{b: 1}"), "found a mapping"),
    "cell-nan": (cell(".nan"), "unexpected"),
    "cell-true": (cell("true"), "not a number"),
    "cell-octal": (cell("0o17"), "no operator"),
    "cell-degree-sign": (cell("90\u00b0"), "deg"),
    "com-two": (changed("m1, com: [0, 0, 0]", "m1, com: [0, 0]"), "2 entries"),
    "com-four": (changed("m1, com: [0, 0, 0]", "m1, com: [0, 0, 0, 0]"), "4 entries"),
    "com-text": (changed("m1, com: [0, 0, 0]", "m1, com: 0"), "allowed: a list"),
    "coulomb-one": (changed("m2,", "m2, friction: {coulomb: [f]},"), "1 entry; allowed: exactly 2; write coulomb: f"),
    "coulomb-three": (changed("m2,", "m2, friction: {coulomb: [1, 2, f]},"), "3 entries; allowed: exactly 2"),
    "coulomb-signed": (changed("m2,", "m2, friction: {coulomb: [1, -0.5]},"), "write 0.5: both numbers are magnitudes"),
    "limits-three": (cell("1, limits: [0, 1, 2]"), "3 entries"),
    "links-too-few": (changed("  - {mass: m2, com: [0, 0, 0]}\n", ""), "1 row for 2 joints"),
    "gravity-two": (changed("[0, 0, -g]", "[0, -g]"), "2 entries"),
    "gravity-number": (changed("[0, 0, -g]", "9.81"), "allowed: a list"),
    "tool-three-rows": (with_tail("tool: [[1,0,0,0],[0,1,0,0],[0,0,1,0]]\n"), "3 entries"),
    "tool-short-row": (with_tail("tool: [[1,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]\n"), "3 entries"),
    "tool-bottom-row": (with_tail(FRAME.format(1, 2)), "bottom row"),
    "tool-scaled": (with_tail(FRAME.format(2, 1)), "length 2"),
    "tool-reflection": (with_tail(FRAME.format(-1, 1)), "reflection"),
    "tool-free-entry": (with_tail(FRAME.format("k", 1)), "rotation for all values"),
    "negative-mass": (changed("mass: m1", "mass: -3"), "negative mass"),
    "negative-mass-by-parameter": (changed("a2: 2}", "a2: 2, m1: -3}"), "negative mass"),
    "division-by-zero": (cell("1/0"), "zero"),
    # not robot files
    "empty": (b"", "empty file"),
    "only-comment": (b"# nothing\n", "empty file"),
    "list": (b"- a\n- b\n", "not a mapping"),
    "text": (b"hello\n", "not a mapping"),
    "null": (b"null\n", "not a mapping"),
    "binary": (bytes(range(256)), "not UTF-8"),
    "elf": (b"\x7fELF\x02\x01\x01\x00" * 10, "control character"),
    "utf-16": (GOOD.encode("utf-16"), "not UTF-8"),
    "latin-1": (changed("title: t", "title: Rob\u00f4").decode().encode("latin-1"), "not UTF-8"),
    "nul": (GOOD.encode() + b"\0", "control character"),
    "tabs": (b"name: r\njoints:\n\t- {type: revolute}\n", "tabs"),
    "unclosed": (b"name: r\njoints: [{type: revolute\n", "not YAML"),
    "unclosed-quote": (b'name: "r\n', "not YAML"),
    "bad-indent": (b"name: r\n  convention: standard\n", "not YAML"),
    "two-documents": (GOOD.encode() + b"---\nname: s\n", "second YAML document"),
    "directive": (b"%TAG ! tag:example.com,2000:\n---\nname: !r r\n", "YAML tag"),
    "list-key": (b"? [a, b]\n: 1\n", "key that is not a text"),
    "noncharacter": (changed("title: t", "title: \ufffe"), "not allowed in YAML"),
}
HOSTILE |= {
    "parameter-not-real": (changed("a2: 2}", "a2: sqrt(-2)}"), "root of a negative"),
    "parameter-pole": (changed("a2: 2}", "a2: 1/cos(pi/2)}"), "division by zero"),
    "tool-never-real": (with_tail(FRAME.format("sqrt(-1 - k**2)", 1)), "no real value"),
}
