# After a run of in.bile_duct_day: size of the lumen over time, and the section at every frame.
# tools/run does this; by hand: PYTHON=python bash after.sh, with tools on PYTHONPATH
set -e
"$PYTHON" -m lammps_dcm lumen lumen.dump --plane z --slab -3 3 -o lumen.csv --plot lumen_area.png
"$PYTHON" -m lammps_dcm render lumen.dump --frame all --section z --size 1000 -o bile_duct_day.png \
  --names "1=hepatoblast,4=cholangiocyte,7=hepatoblast (sphere),8=mesenchyme,9=endothelium,\
10=outermost"
