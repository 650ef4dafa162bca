// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// What a relative accuracy A asks of the numbers that a run may choose, and what mesh and range of
// adhesion leave whatever the steps: from the map of accuracy (doc page accuracy). All factors are
// ours.
// Units: um.

#ifndef DCM_ACCURACY_H
#define DCM_ACCURACY_H

#include <algorithm>

namespace dcm {

/// Tolerance of the solver: a residual of t leaves 0.03 t to 5 t in pressures, areas and places.
inline double accuracy_tolerance(double A)
{
  return std::min(1e-2, A / 20.0);
}

/// Error of a step (length, law/step_control.h) that is let pass as a sudden change, in cells of
/// radius R; the steps between are chosen by law/half_step.h.
inline double accuracy_step(double A, double R)
{
  return A * R / 6.0;
}

/// How far a cell may be off in a step in which it hardly moves (length). Steps that it decides go
/// as its root, and so does what they leave: A^2 makes that A.
inline double accuracy_floor(double A, double R)
{
  return 0.2 * A * A * R;
}

/// Relative error that cells of so many nodes leave in areas and forces of contacts: of second
/// order in the edge, and so inverse to the nodes.
inline double mesh_error(double nodes)
{
  return 6.5 / nodes;
}

/// Nodes of cells that leave an error of A.
inline double mesh_nodes(double A)
{
  return 6.5 / A;
}

/// Relative error in adhering contacts of a mean edge against which the range of adhesion h0 is
/// short: the contact's rim is pinned to the edges. A mean; single orientations have twice that.
inline double range_error(double h0, double edge)
{
  return 0.005 * edge / h0;
}

}    // namespace dcm

#endif
