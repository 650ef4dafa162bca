# After a run of in.lumen: size of the lumen over time, and the section at every frame of the dump.
# tools/run does this; by hand: PYTHON=python bash after.sh, with tools on PYTHONPATH
set -e
"$PYTHON" -m lammps_dcm lumen lumen.dump --plane z --slab -3 3 -o lumen.csv --plot lumen_area.png
"$PYTHON" -m lammps_dcm render lumen.dump --frame all --section z --window -15 15 -15 15 \
  --size 1000 --names 1=cholangiocyte,4=sphere,5=sphere -o lumen.png
