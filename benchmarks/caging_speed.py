"""How fast is caging? Milliseconds for ten grasps of an outline, and for all immobilising grasps that it has.

    python benchmarks/caging_speed.py [--gripper robotiq_2f_85] [--repeat 15]

The outlines are lobed and as rough as a sensor's; machines are noisy, so medians are printed.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from functools import partial
from statistics import median

import numpy as np
from clocks import milliseconds

from flatgrasp_cli import load_gripper
from flatgrasp_cli.geometry.arrays import FloatArray
from flatgrasp_cli.model import Cage
from flatgrasp_cli.profiles import Gripper, load_settings
from flatgrasp_cli.profiles.settings import CagingSettings
from flatgrasp_cli.proof.caging import Hands, immobilising_grasps, prove

GRASPS, PRESHAPE_M = 10, 0.01
SETTINGS = load_settings().caging.model_copy(update={"tolerance_m": 0.0, "max_vertices": 300})


def rough_outline(corners: int, seed: int) -> FloatArray:
    """A loop (corners, 2) about 12 cm across, its vertices displaced by a millimetre."""
    angles = np.linspace(0, 2 * np.pi, corners, endpoint=False)
    noise = np.random.default_rng(seed).normal(0, 0.001, corners)
    radius = 0.05 * (1 + 0.3 * np.cos(3 * angles) + 0.15 * np.cos(5 * angles + 1)) + noise
    return np.column_stack([np.cos(angles), np.sin(angles)]) * radius[:, None]


def certify(loops: list[FloatArray], hands: Hands, gripper: Gripper, settings: CagingSettings) -> tuple[Cage, ...]:
    """The certificates of the hands' grasps."""
    return prove(loops, hands, gripper, settings).cages(hands)


def median_ms(function: Callable[[], object], repeat: int) -> float:
    """Median wall time of a call, after one to warm up."""
    function()
    return median(milliseconds(function) for _ in range(repeat))


def main() -> None:
    """Run the benchmark."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--gripper", default="robotiq_2f_85")
    parser.add_argument("--repeat", type=int, default=15)
    args = parser.parse_args()
    gripper = load_gripper(args.gripper)
    outward = SETTINGS.model_copy(update={"closing": "outward"})
    print(f"{'vertices':>8} {'certify':>8} {'outward':>8} {'all grasps':>10}  ms")
    for corners in (60, 120, 300):
        loops = [rough_outline(corners, 0)]
        found = immobilising_grasps(loops, SETTINGS)
        contacts = np.stack([found[k % len(found)].contacts for k in range(GRASPS)])
        apart = contacts[:, 1] - contacts[:, 0]
        width = np.linalg.norm(apart, axis=1)
        hands = Hands(contacts.mean(axis=1), apart / width[:, None], width, width + PRESHAPE_M)
        figures = [
            median_ms(partial(certify, loops, hands, gripper, settings), args.repeat)
            for settings in (SETTINGS, outward)
        ]
        figures.append(median_ms(partial(immobilising_grasps, loops, SETTINGS), args.repeat))
        print(f"{corners:8} {figures[0]:8.1f} {figures[1]:8.1f} {figures[2]:10.1f}")


if __name__ == "__main__":
    main()
