#include <memory>
#include <numbers>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/json_text.h"
#include "formats/mesh/obj_writer.h"
#include "formats/mesh/surface_reader.h"
#include "precompute/command/commands.h"
#include "precompute/surface/remesh.h"

namespace palpate {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

struct RemeshFlags {
  std::string mesh;
  std::string length_unit;
  std::string output;
  double edge_m = 0.0;
  bool json = false;
};

nlohmann::ordered_json remeshed_json(const RemeshedSurface& made) {
  const RemeshReport& report = made.report;
  return {{"vertices", made.mesh.position_m.rows()},
          {"triangles", made.mesh.triangle.rows()},
          {"edge_mean_before_m", report.edge_mean_before_m},
          {"edge_mean_m", report.edge_mean_m},
          {"smallest_angle_before_rad", report.smallest_angle_before_rad},
          {"smallest_angle_rad", report.smallest_angle_rad},
          {"displaced_m", report.displaced_m},
          {"volume_relative", report.volume_relative},
          {"features", report.features}};
}

void print_remeshed(const RemeshedSurface& made, const std::string& output) {
  const RemeshReport& report = made.report;
  fmt::print("wrote {}: {} vertices, {} triangles, in metres\n", output,
             made.mesh.position_m.rows(), made.mesh.triangle.rows());
  fmt::print("  mean edge       {:.4g} -> {:.4g} m\n", report.edge_mean_before_m,
             report.edge_mean_m);
  fmt::print("  smallest angle  {:.2f} -> {:.2f} deg\n",
             report.smallest_angle_before_rad / kDegree,
             report.smallest_angle_rad / kDegree);
  fmt::print("  moved by        {:.3g} m at most, volume {:+.3f} %\n",
             report.displaced_m, 100.0 * report.volume_relative);
  fmt::print("  sharp edges     {} kept\n", report.features);
}

void run_remesh(const RemeshFlags& flags) {
  const SurfaceMesh mesh = read_surface(flags.mesh, flags.length_unit);
  tell_if_large(mesh, flags.mesh);
  const RemeshedSurface made = remesh_surface(mesh, flags.edge_m);
  write_obj(made.mesh, flags.output,
            fmt::format("made by palpate-precompute remesh {} --edge-m {}", flags.mesh,
                        flags.edge_m));
  if (flags.json) {
    fmt::print("{}\n", json_text(remeshed_json(made), 2));
  } else {
    print_remeshed(made, flags.output);
  }
}

}  // namespace

void tell_if_large(const SurfaceMesh& mesh, std::string_view file) {
  constexpr Eigen::Index kLarge = 200000;
  if (mesh.triangle.rows() > kLarge) {
    fmt::print(stderr, "{}: {} triangles, which takes up to a minute a million\n", file,
               mesh.triangle.rows());
  }
}

void add_remesh_command(Command app) {
  const auto flags = std::make_shared<RemeshFlags>();
  Command command = app.add_subcommand(
      "remesh", "Writes a body's surface anew, with triangles of even size and shape");
  command.add_option("mesh", flags->mesh, "OBJ, STL, PLY or OFF file").required();
  command
      .add_option("--length-unit", flags->length_unit,
                  "unit of the file's coordinates: m, cm, mm, um, in, ...")
      .required();
  command.add_option("-o,--output", flags->output, "OBJ file to write, in metres")
      .required();
  command.add_option("--edge-m", flags->edge_m, "length of the new edges [m]")
      .required();
  command.add_flag("--json", flags->json, "print the report for programs");
  command.callback([flags] {
    run_remesh(*flags);
  });
}

}  // namespace palpate
