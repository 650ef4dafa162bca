"""lammps_dcm: scenes, trajectories, analyses and pictures of deformable cells in LAMMPS."""
__version__ = "0.1.0"
