// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// The system of a linearly implicit Euler step,
//
//   (Gamma + dt K) v = F,    x <- x + dt v,
//
// Gamma the friction of friction.h, K the stiffness of stiffness.h, in the form that FrictionSolver
// asks for. With the exact K = -dF/dx this is the backward Euler step after one Newton iteration
// (Rosenbrock-Euler); any other positive semidefinite K keeps it first-order accurate and changes
// how large dt may be.
// Units: as in friction.h; dt in s.

#ifndef DCM_STEP_SYSTEM_H
#define DCM_STEP_SYSTEM_H

#include "stiffness.h"

namespace dcm {

class StepSystem {
 public:
  int nowned, nall;    // unknowns: owned, owned + those of other processes

  // both stay where they are while this is in use; stiffness keeps work space of its products

  StepSystem(const FrictionSystem &_friction, StiffnessSystem &_stiffness, double _dt) :
      nowned(_friction.nowned), nall(_friction.nall), friction(_friction), stiffness(_stiffness),
      dt(_dt)
  {
  }

  // y = (Gamma + dt K) p of this process' blocks; returns its share of p . y. Collective

  template <class Communicator> double apply(const double *p, double *y, Communicator &comm) const
  {
    const double power = friction.apply(p, y);
    return power + stiffness.apply(dt, (std::size_t) nall + 1, p, y, comm);
  }

  bool isotropic() const { return false; }
  const std::vector<double> &diagonal() const { return friction.diagonal(); }

  void diagonal_blocks(double *d) const
  {
    friction.diagonal_blocks(d);
    stiffness.add_diagonal(dt, d);
  }

 private:
  const FrictionSystem &friction;
  StiffnessSystem &stiffness;
  double dt;
};

}    // namespace dcm

#endif
