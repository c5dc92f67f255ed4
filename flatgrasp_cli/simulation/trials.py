"""All trials of a simulation, one after the other, each from its own seed."""

from __future__ import annotations

from collections.abc import Iterator
from zlib import crc32

import numpy as np
from scipy.spatial.transform import Rotation

from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.simulation.things import Thing, laid
from flatgrasp_cli.simulation.trial import Cell, Trial, attempt
from flatgrasp_cli.simulation.world import World

SCATTER_M = 0.03
"""How far from the spot things are put, along x and y: where a hand would drop them."""
ABOVE_M = 0.002
"""Things are put down from so little above the table that they come to rest as they lie."""
REST_S, HEAP_REST_S = 1.5, 3.0
"""The longest that a thing, and a heap, is waited for to lie still."""
HEAP_GAP_M = 0.05
"""How far above all others each thing of a heap is dropped."""
HEAP_SCATTER_M = 0.08
TRIES_A_THING = 2
"""A heap is given up after so many attempts for each of its things."""


def trials_of(cell: Cell, thing: Thing, count: int) -> Iterator[Trial]:
    """So many trials with one object, each in another pose."""
    world = cell.world([thing])
    for number in range(count):
        rng = _random(cell, thing.name, number)
        look = cell.look(rng)
        world.reset(cell.parked(look), cell.gripper.max_opening_m)
        rests = thing.rests
        rest = rests[rng.choice(len(rests), p=[each.share for each in rests])]
        _put(world, 0, laid(rest, rng.uniform(-np.pi, np.pi)), _scattered(cell.spot, rng, SCATTER_M), ABOVE_M)
        world.settle(REST_S)
        yield attempt(cell, world, look, rng, (number, 0))


def heaps_of(cell: Cell, things: list[Thing], size: int, count: int) -> Iterator[Trial]:
    """So many heaps of `size` things drawn from these, each cleared grasp by grasp until none is found or left."""
    for number in range(count):
        rng = _random(cell, "heap", number)
        chosen = [things[k] for k in rng.integers(len(things), size=size)]
        world = cell.world(chosen)
        look = cell.look(rng)
        world.reset(cell.parked(look), cell.gripper.max_opening_m)
        _heap_up(cell, world, rng)
        for tried in range(TRIES_A_THING * size):
            trial = attempt(cell, world, look, rng, (number, tried))
            yield trial
            if trial.execution is None:
                break
            if trial.execution.thing is not None:
                world.remove(trial.execution.thing)
            if not world.present:
                break
            look = cell.look(rng)
            world.place(cell.parked(look), cell.gripper.max_opening_m)
            world.settle(HEAP_REST_S)


def _random(cell: Cell, name: str, number: int) -> np.random.Generator:
    """The random numbers of a trial: the same whatever else is simulated."""
    return np.random.default_rng([cell.conditions.seed, crc32(name.encode()), number])


def _scattered(spot: FloatArray, rng: np.random.Generator, by_m: float) -> FloatArray:
    return np.asarray(spot + np.array([*rng.uniform(-by_m, by_m, 2), 0.0]))


def _put(world: World, number: int, turn: Rotation, place: FloatArray, height_m: float) -> None:
    """Put a thing down with its centre of mass above a place, its lowest point at a height."""
    thing = world.things[number]
    lowest = turn.apply(np.vstack([piece.vertices for piece in thing.pieces]))[:, 2].min()
    shift = place - turn.apply(thing.center) * [1.0, 1.0, 0.0]
    world.put(number, shift + np.array([0.0, 0.0, height_m - lowest]), turn)


def _heap_up(cell: Cell, world: World, rng: np.random.Generator) -> None:
    """Drop the things one after the other."""
    for number in range(len(world.things)):
        world.remove(number)
    top = 0.0
    for number in range(len(world.things)):
        place = _scattered(cell.spot, rng, HEAP_SCATTER_M)
        world.restore(number)
        _put(world, number, Rotation.random(rng=rng), place, top + HEAP_GAP_M)
        world.settle(HEAP_REST_S)
        top = world.top()
