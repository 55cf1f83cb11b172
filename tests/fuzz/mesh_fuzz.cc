// Any bytes as a mesh file: read, or refused with an Error. The first byte picks the
// format.
#include <array>

#include "formats/base/error.h"
#include "formats/mesh/surface_reader.h"
#include "tests/fuzz/input_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static std::array<palpate::InputFile, 4> files{
      palpate::InputFile(".obj"), palpate::InputFile(".stl"),
      palpate::InputFile(".ply"), palpate::InputFile(".off")};
  if (size == 0) {
    return 0;
  }
  try {
    const palpate::SurfaceMesh mesh =
        palpate::read_surface(files[data[0] % 4].with(data + 1, size - 1), "mm");
    // What was read keeps the promise of the header.
    if (!mesh.position_m.allFinite() ||
        (mesh.triangle.rows() > 0 &&
         (mesh.triangle.minCoeff() < 0 ||
          mesh.triangle.maxCoeff() >= mesh.position_m.rows()))) {
      __builtin_trap();
    }
  } catch (const palpate::Error&) {
  }
  return 0;
}
