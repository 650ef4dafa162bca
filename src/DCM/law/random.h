// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Random numbers that depend only on (seed, cell, step, purpose): the same on any number of ranks,
// in any order of cells, and after a restart, with no state to store.
// Philox4x32-10 (Salmon, Moraes, Dror, Shaw, SC'11), written from its published definition.

#ifndef DCM_RANDOM_H
#define DCM_RANDOM_H

#include "vector.h"

#include <array>
#include <cmath>
#include <cstdint>

namespace dcm {

/// What a number is drawn for. Two purposes never share numbers. Append only: renumbering would
/// change every past result.
enum class RandomPurpose : std::uint32_t {
  GENERAL = 0,
  MOTILITY = 1,
  DIVISION = 2,
  CYCLE = 3,
  TRACER = 4,
  SHAPE = 5,
  QUIESCENCE = 6,
  DEATH = 7,
  CONVERSION = 8,
  POLARITY = 9
};

/// One block of Philox4x32 with 10 rounds: four random words from a counter and a key.
inline std::array<std::uint32_t, 4> philox4x32(std::array<std::uint32_t, 4> ctr,
                                               std::array<std::uint32_t, 2> key)
{
  for (int round = 0; round < 10; round++) {
    const std::uint64_t p0 = std::uint64_t(0xD2511F53u) * ctr[0];
    const std::uint64_t p1 = std::uint64_t(0xCD9E8D57u) * ctr[2];
    ctr = {std::uint32_t(p1 >> 32) ^ ctr[1] ^ key[0], std::uint32_t(p1),
           std::uint32_t(p0 >> 32) ^ ctr[3] ^ key[1], std::uint32_t(p0)};
    key[0] += 0x9E3779B9u;
    key[1] += 0xBB67AE85u;
  }
  return ctr;
}

/// Stream of random numbers of one (seed, cell, step, purpose). Cheap to make; make a new one
/// wherever numbers are needed. At most 2^33 uniform numbers each.
class Random {
 public:
  /// cell: any identifier that does not depend on the rank (molecule ID, atom tag).
  Random(std::uint64_t seed, std::int64_t cell, std::int64_t step,
         RandomPurpose purpose = RandomPurpose::GENERAL) :
      next(2),
      spare(0.0), has_spare(false)
  {
    const std::uint64_t c = std::uint64_t(cell), s = std::uint64_t(step);
    // the counter holds step, low word of the cell and the draw; the rest goes into the key
    const std::uint64_t k = mix(mix(mix(seed) ^ std::uint64_t(purpose)) ^ (c >> 32));
    key = {std::uint32_t(k), std::uint32_t(k >> 32)};
    ctr = {0u, std::uint32_t(c), std::uint32_t(s), std::uint32_t(s >> 32)};
  }

  /// Uniform in (0, 1): never 0, never 1. 52 bits.
  double uniform()
  {
    if (next == 2) {
      const auto w = philox4x32(ctr, key);
      ctr[0]++;
      pair[0] = to_unit(w[0], w[1]);
      pair[1] = to_unit(w[2], w[3]);
      next = 0;
    }
    return pair[next++];
  }

  /// Standard normal: mean 0, variance 1 (Box-Muller).
  double gaussian()
  {
    if (has_spare) {
      has_spare = false;
      return spare;
    }
    const double r = std::sqrt(-2.0 * std::log(uniform()));
    const double phi = 2.0 * PI * uniform();
    spare = r * std::sin(phi);
    has_spare = true;
    return r * std::cos(phi);
  }

  /// Three independent standard normals.
  Vec3 gaussian_vector()
  {
    const double x = gaussian(), y = gaussian(), z = gaussian();
    return Vec3(x, y, z);
  }

  /// Uniform on the unit sphere.
  Vec3 unit_vector()
  {
    const double z = 2.0 * uniform() - 1.0;
    const double phi = 2.0 * PI * uniform();
    const double s = std::sqrt(1.0 - z * z);
    return Vec3(s * std::cos(phi), s * std::sin(phi), z);
  }

 private:
  std::array<std::uint32_t, 4> ctr;
  std::array<std::uint32_t, 2> key;
  double pair[2];
  int next;
  double spare;
  bool has_spare;

  // finalizer of splitmix64: a bijection, every input bit reaches every output bit
  static std::uint64_t mix(std::uint64_t z)
  {
    z += 0x9E3779B97F4A7C15ull;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
    return z ^ (z >> 31);
  }

  // 52 bits plus a half: the midpoint of each bin, hence open at both ends
  static double to_unit(std::uint32_t hi, std::uint32_t lo)
  {
    const std::uint64_t bits = ((std::uint64_t(hi) << 32) | lo) >> 12;
    return (double(bits) + 0.5) * (1.0 / 4503599627370496.0);
  }
};

}    // namespace dcm

#endif
