/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifndef LMP_DCM_RECORD_H
#define LMP_DCM_RECORD_H

#include "pointers.h"

#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

namespace LAMMPS_NS {

// The global state of a fix or pair style in a restart file: numbers, vectors and strings in the
// order in which they are read again, behind a header with the style's name, the version of its
// record, its size and checksums. A record of another version, of none, or one that is damaged
// ends the run with an error.
//
//   DCMRecord record(lmp, STYLE, 2);              DCMRecord record(lmp, STYLE, 2);
//   record.put(count);                            record.load(buf);
//   record.put(values);                           record.get(count); ...
//   record.write(fp);

class DCMRecord : protected Pointers {
 public:
  DCMRecord(class LAMMPS *, const std::string &style, int version);

  // plain data, vectors of it (with their length) and strings

  template <class Item> void put(const Item &item)
  {
    static_assert(std::is_trivially_copyable<Item>::value, "plain data only");
    append(&item, sizeof(Item));
  }
  template <class Item> void put(const std::vector<Item> &items)
  {
    static_assert(std::is_trivially_copyable<Item>::value, "plain data only");
    put((std::int64_t) items.size());
    append(items.data(), items.size() * sizeof(Item));
  }
  void put(const std::string &text) { put(std::vector<char>(text.begin(), text.end())); }

  template <class Item> void get(Item &item) { extract(&item, sizeof(Item)); }
  template <class Item> void get(std::vector<Item> &items)
  {
    std::int64_t n = 0;
    get(n);
    check_left(n, sizeof(Item));
    items.resize(n);
    extract(items.data(), n * sizeof(Item));
  }
  void get(std::string &text)
  {
    std::vector<char> chars;
    get(chars);
    text.assign(chars.begin(), chars.end());
  }

  // whether something is left to get: what a later version of the package added at the end

  bool more() const { return at < bytes.size(); }

  // a fix: on the first process, with the size that LAMMPS expects before it, and from its buffer

  void write(FILE *) const;
  void load(const char *buf);

  // a pair style: read by the first process, for all; nothing before the header

  void write_plain(FILE *) const;
  void read_plain(FILE *);

 private:
  struct Header {
    char magic[8], style[40];
    std::int64_t version, size;
    std::uint64_t checksum, own;    // of the bytes that follow; of the header up to here
  };
  std::string style;
  std::int64_t version;
  std::vector<char> bytes;
  size_t at = 0;

  Header header() const;
  void check_header(const Header &) const;
  void check(bool whole) const;
  void check_left(std::int64_t n, size_t size) const;
  void append(const void *, size_t);
  void extract(void *, size_t);
};

}    // namespace LAMMPS_NS

#endif
