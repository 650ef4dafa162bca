"""A labelled image as a microscope and a segmentation give it: cells that fill a ball, in voxels."""
import numpy as np
from scipy.spatial import cKDTree

seeds = np.random.default_rng(2).uniform(-20.0, 20.0, (400, 3))
seeds = seeds[np.linalg.norm(seeds, axis=1) < 20.0]
chosen = [seeds[0]]
for seed in seeds:
    if cKDTree(chosen).query(seed)[0] > 13.0:    # voxels between the seeds of two cells
        chosen.append(seed)
place = np.indices((60, 60, 60)).reshape(3, -1).T - 29.5
label = cKDTree(chosen).query(place)[1] + 1      # each voxel to the nearest seed
label[np.linalg.norm(place, axis=1) > 27.0] = 0
np.save("tissue.npy", label.reshape(60, 60, 60).astype(np.uint16))
