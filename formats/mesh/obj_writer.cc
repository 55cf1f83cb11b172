#include "formats/mesh/obj_writer.h"

#include <fstream>
#include <iterator>
#include <string>

#include <fmt/format.h>

#include "formats/base/atomic_file.h"
#include "formats/base/error.h"

namespace palpate {

void write_obj(const SurfaceMesh& mesh, const std::filesystem::path& file,
               std::string_view comment) {
  if (file.extension() != ".obj") {
    throw InputError(
        fmt::format("{}: surfaces are written as .obj files only", file.string()));
  }
  std::string text = fmt::format("# {}\n# lengths in metres\n", comment);
  const auto end = std::back_inserter(text);
  for (Eigen::Index v = 0; v < mesh.position_m.rows(); ++v) {
    fmt::format_to(end, "v {} {} {}\n", mesh.position_m(v, 0), mesh.position_m(v, 1),
                   mesh.position_m(v, 2));
  }
  for (Eigen::Index t = 0; t < mesh.triangle.rows(); ++t) {
    fmt::format_to(end, "f {} {} {}\n", mesh.triangle(t, 0) + 1,
                   mesh.triangle(t, 1) + 1, mesh.triangle(t, 2) + 1);
  }
  AtomicFile target(file);
  std::ofstream out(target.temporary(), std::ios::binary);
  out << text;
  out.close();
  if (!out) {
    throw InputError(fmt::format("{}: cannot be written", file.string()));
  }
  target.commit();
}

}  // namespace palpate
