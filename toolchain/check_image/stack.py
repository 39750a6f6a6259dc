"""Calculates the maximum stack depth of a function with its callees, and of a main loop with interrupts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

# The maximum number of bytes that the entry of an exception pushes if the code does not use a floating-point unit:
# eight words, and one more word if the stack is not aligned to eight bytes (Armv7-M ARM B1.5.6 and B1.5.7).
EXCEPTION_FRAME = 32 + 4


@dataclass(frozen=True)
class Node:
    name: str
    frame: int  # bytes
    calls: frozenset[int]
    problem: str = ""  # why this function makes the stack depth unknown; empty if it does not


Graph = dict[int, Node]  # by address


class Unbounded(Exception):
    """The stack depth of a function with its callees has no known upper bound."""


@dataclass(frozen=True)
class Chain:
    """Functions, each of which calls the next one. The next one is always the callee with the deepest stack."""

    nodes: tuple[Node, ...]

    @property
    def size(self) -> int:
        return sum(node.frame for node in self.nodes)

    def __str__(self) -> str:
        return " -> ".join(f"{node.name} {node.frame}" for node in self.nodes)


@dataclass(frozen=True)
class Level:
    """Exception handlers that cannot interrupt each other."""

    name: str
    handlers: Sequence[int]  # addresses


class DeepestChains:
    """Finds the deepest chain that begins with a function, and caches each chain that it has found."""

    def __init__(self, graph: Mapping[int, Node]) -> None:
        self._graph = graph
        self._found: dict[int, Chain] = {}
        self._path: list[int] = []

    def below(self, address: int) -> Chain:
        if address in self._found:
            return self._found[address]
        if address in self._path:
            cycle = self._path[self._path.index(address) :] + [address]
            raise Unbounded(f"recursion: {self._names(cycle)}; use a loop")
        self._path.append(address)
        node = self._graph[address]
        if node.problem:
            raise Unbounded(f"{node.name}, reached by {self._names(self._path)}: {node.problem}")
        deepest = max(
            (self.below(callee) for callee in sorted(node.calls)), key=lambda c: c.size, default=Chain(())
        )
        self._path.pop()
        chain = self._found[address] = Chain((node, *deepest.nodes))
        return chain

    def _names(self, path: Sequence[int]) -> str:
        return " -> ".join(self._graph[address].name for address in path)


@dataclass(frozen=True)
class Interruption:
    level: str
    chain: Chain

    @property
    def size(self) -> int:
        return EXCEPTION_FRAME + self.chain.size


@dataclass(frozen=True)
class WorstCase:
    """The deepest chain from the reset handler, which runs the main loop. For each level that has handlers, also the
    deepest chain from one of these handlers."""

    main: Chain
    interruptions: tuple[Interruption, ...]

    @property
    def size(self) -> int:
        return self.main.size + sum(interruption.size for interruption in self.interruptions)


def worst_case(graph: Mapping[int, Node], reset: int, levels: Sequence[Level]) -> WorstCase:
    """Calculates the worst case. Raises Unbounded if a stack depth is unknown. `reset`: the reset handler's address."""
    chains = DeepestChains(graph)
    return WorstCase(
        chains.below(reset),
        tuple(
            Interruption(
                level.name, max((chains.below(h) for h in level.handlers), key=lambda chain: chain.size)
            )
            for level in levels
            if level.handlers
        ),
    )
