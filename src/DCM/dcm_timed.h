/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifndef LMP_DCM_TIMED_H
#define LMP_DCM_TIMED_H

#include "platform.h"

#include <optional>
#include <string>

namespace LAMMPS_NS {

// What each style of the deck took: the styles of this package are known to LAMMPS as
// DCMTimedFix<Style>, DCMTimedForce<Style> and DCMTimedCompute<Style>, which are the style with a
// watch at the calls that LAMMPS makes in each step. The styles themselves know nothing of it.
// After a run the last fix prints the table, and what the styles have to tell of the run.

class DCMWatch {
 public:
  double seconds = 0.0;    // of this process, in the run, without what other watches took in it

  // counts from where it is made to the end of the block. A style that reads a compute has a span
  // inside its own: each second belongs to one watch, the innermost

  class Span {
   public:
    explicit Span(DCMWatch &w) : watch(w), start(platform::walltime()), before(counted) {}
    ~Span()
    {
      const double all = platform::walltime() - start;
      watch.seconds += all - (counted - before);
      counted = before + all;
    }
    Span(const Span &) = delete;
    Span &operator=(const Span &) = delete;

   private:
    DCMWatch &watch;
    const double start, before;

    inline static double counted = 0.0;    // by all watches together, ever
  };

  // computes are asked in set-up as well, after the watches were put back to zero

  static bool in_run(class LAMMPS *);

  // all back to zero; make a table of all, with what each style did. Collective; only the last
  // style of the deck is listened to, when all others are done

  static void begin(class LAMMPS *, const DCMWatch *);
  static void look(class LAMMPS *, DCMWatch *);

  // print the table, when LAMMPS has printed what belongs to the run: before the next one, or when
  // the style goes. Between thermo output and "Loop time" other programs expect thermo output

  void tell(class LAMMPS *);

 protected:
  std::string table;

  virtual ~DCMWatch() noexcept(false) {}    // as that of LAMMPS' classes
};

template <class Style> class DCMTimedFix : public Style, public DCMWatch {
 public:
  using Style::Style;
  ~DCMTimedFix() override { tell(this->lmp); }

  void init() override
  {
    tell(this->lmp);
    Style::init();
  }
  void initial_integrate(int vflag) override
  {
    const Span span(*this);
    Style::initial_integrate(vflag);
  }
  void post_integrate() override
  {
    const Span span(*this);
    Style::post_integrate();
  }
  void pre_exchange() override
  {
    const Span span(*this);
    Style::pre_exchange();
  }
  void pre_neighbor() override
  {
    const Span span(*this);
    Style::pre_neighbor();
  }
  void post_neighbor() override
  {
    const Span span(*this);
    Style::post_neighbor();
  }
  void pre_force(int vflag) override
  {
    const Span span(*this);
    Style::pre_force(vflag);
  }
  void pre_reverse(int eflag, int vflag) override
  {
    const Span span(*this);
    Style::pre_reverse(eflag, vflag);
  }
  void post_force(int vflag) override
  {
    const Span span(*this);
    Style::post_force(vflag);
  }
  void final_integrate() override
  {
    const Span span(*this);
    Style::final_integrate();
  }
  void end_of_step() override
  {
    const Span span(*this);
    Style::end_of_step();
  }
  void setup(int vflag) override
  {
    Style::setup(vflag);
    begin(this->lmp, this);
  }
  void post_run() override
  {
    Style::post_run();
    look(this->lmp, this);
  }
};

// bond, dihedral and pair styles

template <class Style> class DCMTimedForce : public Style, public DCMWatch {
 public:
  using Style::Style;

  void compute(int eflag, int vflag) override
  {
    const Span span(*this);
    Style::compute(eflag, vflag);
  }
};

template <class Style> class DCMTimedCompute : public Style, public DCMWatch {
 public:
  using Style::Style;

  double compute_scalar() override
  {
    const RunSpan span(*this);
    return Style::compute_scalar();
  }
  void compute_vector() override
  {
    const RunSpan span(*this);
    Style::compute_vector();
  }
  void compute_array() override
  {
    const RunSpan span(*this);
    Style::compute_array();
  }
  void compute_peratom() override
  {
    const RunSpan span(*this);
    Style::compute_peratom();
  }
  void compute_local() override
  {
    const RunSpan span(*this);
    Style::compute_local();
  }

 private:
  struct RunSpan : std::optional<Span> {
    explicit RunSpan(DCMTimedCompute &me)
    {
      if (in_run(me.lmp)) this->emplace(me);
    }
  };
};

}    // namespace LAMMPS_NS

#endif
