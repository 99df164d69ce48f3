"""`stlspec.gym.STLReward`: a spec as the reward of any reinforcement-learning library.

Importing this module loads gymnasium, which `import stlspec` does not, and makes `stlspec/GridWorld-v0` known to it, so
that gymnasium.make("stlspec.gym:stlspec/GridWorld-v0") needs no other import. It is no replacement for gymnasium and
does not stand in its way: `import gymnasium` stays what it is.
"""

from stlspec.envs import gridworld
from stlspec.wrapper import STLReward

__all__ = ["STLReward"]

# A process that has the module but not the environment, such as one whose registry was emptied, gets it back.
gridworld.register()
