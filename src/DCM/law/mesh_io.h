// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Reading closed surfaces from text files: OFF (Geomview) and OBJ (Wavefront), triangles only.

#ifndef DCM_MESH_IO_H
#define DCM_MESH_IO_H

#include "mesh.h"

#include <cctype>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>

namespace dcm {

namespace mesh_detail {

  /// Words of a text file, line by line, with comments (#) and blank lines left out. Lines end as
  /// on Unix, Windows or an old Mac; the mark (BOM) that some editors put before the first is
  /// skipped.
  class LineReader {
   public:
    explicit LineReader(const std::string &path) : file(path), name(path), number(0)
    {
      if (!file)
        throw std::runtime_error("cannot open mesh file " + path + " (" + std::strerror(errno) +
                                 "): check its name and the folder the run starts in");
      for (const char c : {'\xEF', '\xBB', '\xBF'})
        if (file.peek() == (unsigned char) c) file.get();
    }

    /// Next line with words on it; false at the end of the file.
    bool next()
    {
      std::string line;
      while (get_line(line)) {
        line.erase(std::find(line.begin(), line.end(), '#'), line.end());
        words.clear();
        for (size_t i = 0; i < line.size();) {
          size_t j = i;
          while (j < line.size() && !std::isspace((unsigned char) line[j])) j++;
          if (j > i) words.push_back(line.substr(i, j - i));
          i = j + 1;
        }
        if (!words.empty()) return true;
      }
      if (file.bad()) fail("cannot be read further", "check the disk and the file's permissions");
      return false;
    }

    /// Throw std::runtime_error naming file, line, fault and remedy.
    [[noreturn]] void fail(const std::string &what, const std::string &remedy) const
    {
      throw std::runtime_error("mesh file " + name + ", line " + std::to_string(number) + ": " +
                               what + ": " + remedy);
    }

    double real(const std::string &word) const
    {
      char *end = nullptr;
      const double x = std::strtod(word.c_str(), &end);
      if (end == word.c_str() || *end || !std::isfinite(x))
        fail("'" + word + "' is not a finite number", "correct or export the file again");
      return x;
    }

    long integer(const std::string &word) const
    {
      char *end = nullptr;
      errno = 0;
      const long i = std::strtol(word.c_str(), &end, 10);
      if (end == word.c_str() || *end || errno || std::labs(i) > 2000000000L)
        fail("'" + word + "' is not an integer", "correct or export the file again");
      return i;
    }

    std::vector<std::string> words;
    bool joins = false;    ///< A backslash at the end of a line joins the next one to it.

   private:
    bool get_line(std::string &line)
    {
      line.clear();
      int c = file.get();
      if (!file) return false;
      number++;
      for (;; c = file.get()) {
        if (!file || c == '\n' || c == '\r') {
          if (c == '\r' && file.peek() == '\n') file.get();
          if (!joins || line.empty() || line.back() != '\\' || !file) return true;
          line.back() = ' ';
          number++;
        } else {
          line += char(c);
        }
      }
    }

    std::ifstream file;
    std::string name;
    long number;
  };

  inline Mesh read_off(LineReader &in)
  {
    if (!in.next()) in.fail("the file is empty", "export the mesh again");
    // off in lower case, or with the counts right behind it, is what some programs write
    std::string begin = in.words[0].substr(0, 3), glued = in.words[0].substr(begin.size());
    for (char &c : begin) c = char(std::toupper((unsigned char) c));
    const bool counts =
        !glued.empty() && std::all_of(glued.begin(), glued.end(), [](unsigned char c) {
          return std::isdigit(c);
        });
    if (begin != "OFF" || !(glued.empty() || counts))
      in.fail("an OFF file starts with the word OFF, not '" + in.words[0] + "'",
              "export plain OFF (no colors, normals or binary)");
    if (counts)
      in.words[0] = glued;
    else
      in.words.erase(in.words.begin());
    if (in.words.empty() && !in.next())
      in.fail("the file ends before the counts", "it is truncated, export or copy it again");
    if (in.words[0] == "BINARY") in.fail("binary OFF is not supported", "export it as text");
    if (in.words.size() < 2)
      in.fail("the numbers of nodes, faces and edges belong here", "export the mesh again");
    const long nn = in.integer(in.words[0]), nf = in.integer(in.words[1]);
    if (nn <= 0 || nf <= 0)
      in.fail("the numbers of nodes and faces must be positive", "export the mesh again");

    // no reserve: a wrong count in the header must not exhaust the memory
    Mesh mesh;
    for (long i = 0; i < nn; i++) {
      if (!in.next())
        in.fail("the file ends after " + std::to_string(i) + " of " + std::to_string(nn) + " nodes",
                "it is truncated, export or copy it again");
      if (in.words.size() < 3)
        in.fail("node " + std::to_string(i + 1) + " needs three coordinates",
                "correct or export the file again");
      mesh.nodes.emplace_back(in.real(in.words[0]), in.real(in.words[1]), in.real(in.words[2]));
    }
    for (long i = 0; i < nf; i++) {
      if (!in.next())
        in.fail("the file ends after " + std::to_string(i) + " of " + std::to_string(nf) + " faces",
                "it is truncated, export or copy it again");
      const long n = in.integer(in.words[0]);
      if (n != 3)
        in.fail("face " + std::to_string(i + 1) + " has " + std::to_string(n) + " corners",
                "only triangles are read, triangulate the mesh");
      if (in.words.size() < 4)
        in.fail("face " + std::to_string(i + 1) + " needs three nodes",
                "correct or export the file again");
      std::array<int, 3> f;
      for (int k = 0; k < 3; k++) {
        const long j = in.integer(in.words[k + 1]);
        if (j < 0 || j >= nn)
          in.fail("face " + std::to_string(i + 1) + " refers to node index " + std::to_string(j),
                  "this OFF file has indices 0 to " + std::to_string(nn - 1));
        f[k] = int(j);
      }
      mesh.faces.push_back(f);
    }
    if (in.next() && in.words.size() >= 3 && in.words[0] == "3")
      in.fail("there are more faces than the " + std::to_string(nf) + " announced",
              "correct the counts in the second line");
    return mesh;
  }

  inline Mesh read_obj(LineReader &in)
  {
    Mesh mesh;
    in.joins = true;
    while (in.next()) {
      if (in.words[0] == "v") {
        if (in.words.size() < 4)
          in.fail("a node (v) needs three coordinates",
                  "the file is truncated or damaged, export it again");
        mesh.nodes.emplace_back(in.real(in.words[1]), in.real(in.words[2]), in.real(in.words[3]));
      } else if (in.words[0] == "f") {
        if (in.words.size() < 4)
          in.fail("a face (f) needs three nodes",
                  "the file is truncated or damaged, export it again");
        if (in.words.size() > 4)
          in.fail("this face has " + std::to_string(in.words.size() - 1) + " corners",
                  "only triangles are read, triangulate the mesh");
        std::array<int, 3> f;
        for (int k = 0; k < 3; k++) {
          std::string word = in.words[k + 1];
          word = word.substr(0, word.find('/'));    // node/texture/normal
          long j = in.integer(word);
          const long nn = long(mesh.nodes.size());
          if (j < 0) j += nn + 1;    // counted back from the latest node
          if (j < 1 || j > nn)
            in.fail("this face refers to node " + word + " of " + std::to_string(nn) +
                        " nodes read so far",
                    "OBJ counts nodes from 1, and they must stand before the faces");
          f[k] = int(j - 1);
        }
        mesh.faces.push_back(f);
      }
      // all other keywords describe textures, materials and groups
    }
    if (mesh.nodes.empty()) in.fail("the file ends without any node (v)", "export the mesh again");
    if (mesh.faces.empty())
      in.fail("the file ends without any face (f)", "it is truncated or a point cloud");
    return mesh;
  }

}    // namespace mesh_detail

namespace mesh_detail {
  inline std::string lower_ending(const std::string &path)
  {
    const size_t dot = path.rfind('.');
    std::string ending = dot == std::string::npos ? "" : path.substr(dot + 1);
    for (char &c : ending) c = char(std::tolower((unsigned char) c));
    return ending;
  }
}    // namespace mesh_detail

/// Is this the name of a file that read_mesh() reads: .off or .obj, any case?
inline bool is_mesh_file(const std::string &path)
{
  const std::string ending = mesh_detail::lower_ending(path);
  return ending == "off" || ending == "obj";
}

/// Read a surface from an OFF or OBJ text file, told apart by the ending of the name (.off or
/// .obj, any case). Coordinates are taken as they stand. Throws std::runtime_error naming file,
/// line and remedy; a file cut short is detected. Whether the surface can be a cell is for
/// check_mesh().
inline Mesh read_mesh(const std::string &path)
{
  const std::string ending = mesh_detail::lower_ending(path);
  if (!is_mesh_file(path))
    throw std::runtime_error("mesh file " + path +
                             " is of unknown kind: its name must end in .off or .obj");
  mesh_detail::LineReader in(path);
  return ending == "off" ? mesh_detail::read_off(in) : mesh_detail::read_obj(in);
}

}    // namespace dcm

#endif
