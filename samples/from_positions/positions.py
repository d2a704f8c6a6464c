"""Joint positions of a walk in the order of HumanML3D, with noise, as a pose estimator would give them.

Usage: positions.py walk.npz OUT.npy [MILLIMETRES OF NOISE]
"""

import sys

import numpy as np

ORDER = ["Hips", "LeftUpLeg", "RightUpLeg", "Spine", "LeftLeg", "RightLeg", "Spine1", "LeftFoot", "RightFoot", "Spine2",
         "LeftToeBase", "RightToeBase", "Neck", "LeftShoulder", "RightShoulder", "Head", "LeftArm", "RightArm",
         "LeftForeArm", "RightForeArm", "LeftHand", "RightHand"]

walk = np.load(sys.argv[1])
names = list(walk["names"])
places = walk["positions"][:, [names.index(name) for name in ORDER]]
noise = np.random.default_rng(1).normal(0, float(sys.argv[3] if len(sys.argv) > 3 else 0) / 1000, places.shape)
np.save(sys.argv[2], (places + noise).astype(np.float32))
