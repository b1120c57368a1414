"""Cheaper programs for the same values: as networks of polynomials in which shared parts are searched for.

The hoisted part of a program is improved like a body, with the parameters for arguments.
"""

from collections import Counter
from collections.abc import Sequence
from functools import reduce

from derive.programs.optimise.coefficients import Coefficients
from derive.programs.optimise.network import ROOT, Definition, Monomial, Network, Opaque, Operand, Polynomial
from derive.programs.optimise.search import Search
from derive.programs.optimise.search_policy import POLICY
from derive.programs.tape.build import apply, copy, copy_leaf, program_cost, reachable
from derive.programs.tape.graph import ONE, ZERO, Graph, Ref, is_negative, node_of, ref_to, signed
from derive.programs.tape.tape import LEAVES, Layer, Op
from derive.programs.tape.value import Value

_SUMS = (Op.ADD, Op.SUBTRACT)


def improve(graph: Graph, outputs: Sequence[Ref]) -> tuple[Graph, tuple[Ref, ...]]:
    """The same values for fewer operations."""
    improvement = Improvement(graph, outputs)
    improvement.search()
    return improvement.result()


def improved_values(values: Sequence[Value]) -> list[Value]:
    """The same values from fewer operations, in the same graph."""
    if not values:
        return []
    graph = values[0].graph
    fresh, refs = improve(graph, [value.ref for value in values])
    return [Value(graph, ref) for ref in copy(fresh, refs, graph, {})]


class Improvement:
    """The improvement of one program, which may be taken further step by step."""

    def __init__(self, graph: Graph, outputs: Sequence[Ref]) -> None:
        self._graph = graph
        self._outputs = tuple(outputs)
        self._network = network_of(graph, outputs)
        self._search = Search(self._network)

    @property
    def cost(self) -> int:
        """Cost of the body of the program found so far."""
        return self._network.cost

    def draft(self) -> None:
        """Search for a short time."""
        self._search.run(POLICY.draft_work)

    def search(self, work: int = POLICY.search_work) -> None:
        """Search for long."""
        self._search.run(work // 2)
        self._search.resubstitute(work)
        self._search.run(work // 2)
        self._search.move_coefficients()

    def result(self) -> tuple[Graph, tuple[Ref, ...]]:
        """The cheapest program found so far, its hoisted work improved too."""
        programs = (self._graph, self._outputs), graph_of(self._network, self._graph)
        graph, outputs = min(programs, key=lambda program: program_cost(*program))  # of equals the old one
        used = {node_of(ref) for ref in outputs}
        used.update(k for i in reachable(graph, outputs) if graph.layer[i] is Layer.BODY for k in graph.operands[i])
        results = sorted(i for i in used if graph.layer[i] is Layer.HOISTED and graph.op[i] not in LEAVES)
        if not results:
            return graph, outputs
        network = network_of(graph, [ref_to(i) for i in results], Layer.HOISTED)
        Search(network).run(POLICY.hoisted_work)
        fresh, moved = graph_of(network, graph)
        programs = (graph, outputs), (fresh, copy(graph, outputs, fresh, dict(zip(results, moved, strict=True))))
        return min(programs, key=lambda program: program_cost(*program))

    def close(self) -> None:
        """Cut the network's reference to what watches it: without this circle its memory is free at once."""
        self._network.watcher = None


def network_of(graph: Graph, outputs: Sequence[Ref], body: Layer = Layer.BODY) -> Network:
    """The network of some outputs; sums in sums and products in either are one where the inner serves nothing else."""
    return _GraphReader(graph, outputs, body).network


class _GraphReader:
    def __init__(self, graph: Graph, outputs: Sequence[Ref], body: Layer) -> None:
        self._old = graph
        self._body = body
        self._coefficients = Coefficients(Graph())
        self._values: dict[int, Operand] = {}
        self._uses: Counter[int] = Counter(node_of(ref) for ref in outputs)
        self._user: dict[int, Op] = {}
        self.network = Network(self._coefficients)
        order = reachable(graph, outputs)
        for i in order:
            for k in graph.operands[i]:
                self._uses[k] += 1
                self._user[k] = graph.op[i]
        for i in order:
            if not self._is_absorbed(i):
                self._values[i] = self._value(i)
        operands = ((self._values[node_of(ref)], is_negative(ref)) for ref in outputs)
        results = tuple(Operand(value.variable, signed(value.coefficient, minus)) for value, minus in operands)
        self.network.define(ROOT, Opaque(None, results))
        self.network.settle()

    def _is_absorbed(self, i: int) -> bool:
        """Whether a sum or product is part of a larger one and of nothing else."""
        op, user = self._old.op[i], self._user.get(i)
        if self._uses[i] != 1 or user is None or self._old.layer[i] < self._body:
            return False
        return (op in _SUMS and user in _SUMS) or (op is Op.MULTIPLY and user in (*_SUMS, Op.MULTIPLY))

    def _value(self, i: int) -> Operand:
        """A node as an operand: a coefficient, or a new variable unless the value is zero or known."""
        old, coefficients = self._old, self._coefficients
        op = old.op[i]
        if old.layer[i] < self._body:
            if op in LEAVES:
                return Operand(None, coefficients.same(copy_leaf(old, i, coefficients.graph)))
            operands = [self._values[k].coefficient for k in old.operands[i]]
            return Operand(None, coefficients.same(apply(coefficients.graph, op, operands)))
        if op in LEAVES:
            return Operand(self.network.create(Opaque(None, (), i)), ONE)
        definition: Definition
        if op in _SUMS or op is Op.MULTIPLY:
            definition = self._polynomial(i)
        else:
            definition = Opaque(op, tuple(self._values[k] for k in old.operands[i]))
        return self.network.find(self.network.evaluate(definition)) or Operand(self.network.create(definition), ONE)

    def _polynomial(self, root: int) -> Polynomial:
        """A sum of products, or one product."""
        old, result = self._old, Polynomial()
        stack = [(False, root)]
        while stack:
            negative, i = stack.pop()
            if old.op[i] in _SUMS and (i == root or self._is_absorbed(i)):
                left, right = old.operands[i]
                stack.append((negative ^ (old.op[i] is Op.SUBTRACT), right))
                stack.append((negative, left))
            else:
                monomial, coefficient = self._term(i, i == root)
                if coefficient != ZERO:
                    self.network.plus(result, monomial, signed(coefficient, negative))
        return result

    def _term(self, root: int, is_root: bool) -> tuple[Monomial, Ref]:
        """A product, or a value as a factor."""
        factors: list[int] = []
        coefficient = ONE
        stack = [root]
        while stack:
            i = stack.pop()
            if self._old.op[i] is Op.MULTIPLY and ((i == root and is_root) or self._is_absorbed(i)):
                stack.extend(self._old.operands[i])
                continue
            operand = self._values[i]
            coefficient = self._coefficients.multiply(coefficient, operand.coefficient)
            if operand.variable is not None:
                factors.append(operand.variable)
        return tuple(sorted(factors)), coefficient


def graph_of(network: Network, old: Graph) -> tuple[Graph, tuple[Ref, ...]]:
    """The operations of a network in a graph."""
    graph = network.coefficients.graph
    refs: dict[int, Ref] = {}

    def _ref_of(operand: Operand) -> Ref:
        if operand.variable is None:
            return operand.coefficient
        return signed(refs[operand.variable], is_negative(operand.coefficient))

    for variable in network.order():
        definition = network.definition[variable]
        if not isinstance(definition, Opaque):
            terms = [reduce(graph.multiply, sorted(refs[v] for v in m), factor) for m, factor in definition.items()]
            terms.sort(key=lambda ref: (graph.layer[node_of(ref)], ref))  # coefficients first
            refs[variable] = reduce(graph.add, terms, ZERO)
        elif definition.op is None:
            refs[variable] = copy_leaf(old, definition.source, graph)
        else:
            refs[variable] = apply(graph, definition.op, [_ref_of(operand) for operand in definition.operands])
    root = network.definition[ROOT]
    assert isinstance(root, Opaque)
    return graph, tuple(_ref_of(operand) for operand in root.operands)
