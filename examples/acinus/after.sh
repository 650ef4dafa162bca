# After a run of in.acinus: size of the lumen over time, the lumen in space at the end, and the
# section at every frame of the dump.
# tools/run does this; by hand: PYTHON=python bash after.sh, with tools on PYTHONPATH
set -e
"$PYTHON" -m lammps_dcm lumen lumen.dump -o lumen.csv --plot lumen_size.png
"$PYTHON" -m lammps_dcm render lumen.dump --lumen --view iso --size 1000 \
  --names 1=epithelium -o acinus_3d.png
"$PYTHON" -m lammps_dcm render lumen.dump --frame all --section z \
  --window -20 20 -20 20 --size 1000 --names 1=epithelium -o acinus.png
