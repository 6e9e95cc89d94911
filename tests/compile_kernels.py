"""Compile all kernels once, before several processes run the tests: each would compile its own."""

from trecsim.fusion.warmup import warm_up
from trecsim.lab.simulation.scene import room_scene, simulate


def main() -> None:
    """Run the kernels of the fusion and of the simulation; later runs load them from the cache."""
    warm_up()
    simulate(room_scene(people=2, cameras=2, seconds=0.5), seed=0)


if __name__ == "__main__":
    main()
