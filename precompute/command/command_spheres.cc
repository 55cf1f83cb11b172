#include <memory>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/error.h"
#include "formats/base/json_text.h"
#include "formats/mesh/surface_reader.h"
#include "formats/response/tool_shape.h"
#include "precompute/command/commands.h"
#include "precompute/surface/contact_spheres.h"

namespace palpate {
namespace {

struct SpheresFlags {
  std::string mesh;
  std::string length_unit;
  std::size_t count = 16;
  double radius_m = 0.0;
  bool json = false;
};

nlohmann::ordered_json spheres_json(const ContactSpheres& spheres) {
  nlohmann::ordered_json centres = nlohmann::ordered_json::array();
  for (const auto& centre : spheres.centre_m.rowwise()) {
    centres.push_back({centre.x(), centre.y(), centre.z()});
  }
  return {{"centre_m", centres},
          {"radius_m", spheres.radius_m},
          {"largest_error_m", spheres.largest_error_m},
          {"rms_error_m", spheres.rms_error_m}};
}

// As a scene has it.
void print_spheres(const SpheresFlags& flags, const ContactSpheres& spheres) {
  fmt::print("# {} spheres for {}: {:.3g} mm off at most, {:.3g} mm rms\n",
             spheres.centre_m.rows(), flags.mesh, 1e3 * spheres.largest_error_m,
             1e3 * spheres.rms_error_m);
  fmt::print("[[tool]]\nname = \"tool\"\nshape = \"spheres\"\nradius_m = {:.6g}\n",
             spheres.radius_m);
  fmt::print("centre_m = [\n");
  for (const auto& centre : spheres.centre_m.rowwise()) {
    fmt::print("  [{:.6g}, {:.6g}, {:.6g}],\n", centre.x(), centre.y(), centre.z());
  }
  fmt::print("]\n");
}

void run_spheres(const SpheresFlags& flags) {
  if (!(flags.radius_m >= 0.0 && flags.radius_m < 1e3)) {
    throw InputError(fmt::format(
        "--radius-m {}: must lie in [0, 1000); 0 finds the one that fits best",
        flags.radius_m));
  }
  const SurfaceMesh tool = read_surface(flags.mesh, flags.length_unit);
  const ContactSpheres spheres = contact_spheres(tool, flags.count, flags.radius_m);
  if (flags.json) {
    fmt::print("{}\n", json_text(spheres_json(spheres)));
  } else {
    print_spheres(flags, spheres);
  }
}

}  // namespace

void add_spheres_command(Command app) {
  Command command = app.add_subcommand(
      "spheres", "Find spheres by which a tool's mesh touches, for a scene");
  auto flags = std::make_shared<SpheresFlags>();
  command.add_option("mesh", flags->mesh, "Surface of the tool (OBJ, STL, PLY, OFF)")
      .required();
  command.add_option("--length-unit", flags->length_unit, "Of the mesh file: m, cm, mm")
      .required();
  command.add_option("--count", flags->count, "How many spheres")
      .in_range(std::int64_t{1}, kMostContacts)
      .show_default();
  command.add_option("--radius-m", flags->radius_m,
                     "Their radius [m]; else the one that fits best");
  command.add_flag("--json", flags->json, "Print the report as one JSON object");
  command.callback([flags] {
    run_spheres(*flags);
  });
}

}  // namespace palpate
