#include "precompute/command_check.h"

#include <memory>
#include <numbers>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/error.h"
#include "precompute/surface_check.h"
#include "precompute/surface_reader.h"

namespace palpate {
namespace {

struct CheckFlags {
  std::string mesh;
  std::string length_unit;
  bool json = false;
};

double degrees(double angle_rad) {
  return angle_rad * 180.0 / std::numbers::pi;
}

nlohmann::json to_json(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

nlohmann::json to_json(const SurfaceReport& report) {
  nlohmann::json json{{"accepted", report.accepted()},
                      {"verdict", report.verdict()},
                      {"vertices", report.vertices},
                      {"triangles", report.triangles},
                      {"components", report.components},
                      {"components_turned", report.components_turned},
                      {"closed", report.closed()},
                      {"area_m2", report.area_m2},
                      {"volume_m3", report.volume_m3},
                      {"extent_m", to_json(report.extent_m)},
                      {"edge_mean_m", report.edge_mean_m},
                      {"smallest_angle_rad", report.smallest_angle_rad}};
  for (const DefectKind& kind : defect_kinds()) {
    const SurfaceDefect& defect = report.*kind.defect;
    nlohmann::json where = nlohmann::json::array();
    for (const Eigen::Vector3d& p : defect.where_m) {
      where.push_back(to_json(p));
    }
    json["defects"][kind.key] = {{"count", defect.count}, {"where_m", where}};
  }
  return json;
}

void print_table(const SurfaceReport& report) {
  const Eigen::Vector3d& size_m = report.extent_m;
  fmt::print("  vertices              {}\n", report.vertices);
  fmt::print("  triangles             {}\n", report.triangles);
  fmt::print("  parts                 {}\n", report.components);
  fmt::print("  size [m]              {:.6g} x {:.6g} x {:.6g}\n", size_m.x(),
             size_m.y(), size_m.z());
  fmt::print("  area [m^2]            {:.6g}\n", report.area_m2);
  fmt::print("  volume [m^3]          {:.6g}\n", report.volume_m3);
  fmt::print("  mean edge [m]         {:.4g}\n", report.edge_mean_m);
  fmt::print("  smallest angle        {:.2f} deg\n",
             degrees(report.smallest_angle_rad));
  for (const DefectKind& kind : defect_kinds()) {
    fmt::print("  {:<22}{}\n", kind.key, (report.*kind.defect).count);
  }
}

void run_check(const CheckFlags& flags) {
  const CheckedSurface checked =
      check_surface(read_surface(flags.mesh, flags.length_unit));
  const SurfaceReport& report = checked.report;
  if (flags.json) {
    fmt::print("{}\n", to_json(report).dump(2));
  } else {
    fmt::print("{}: {}\n", flags.mesh, report.verdict());
    print_table(report);
  }
  if (!report.accepted()) {
    throw InputError(fmt::format("{}: {}", flags.mesh, report.verdict()));
  }
}

}  // namespace

void add_check_command(CLI::App& app) {
  const auto flags = std::make_shared<CheckFlags>();
  CLI::App* command =
      app.add_subcommand("check", "Reports whether a surface mesh bounds a body");
  command->add_option("mesh", flags->mesh, "OBJ, STL, PLY or OFF file")->required();
  command
      ->add_option("--length-unit", flags->length_unit,
                   "unit of the file's coordinates: m, cm, mm, um, in, ...")
      ->required();
  command->add_flag("--json", flags->json, "print the report for programs");
  command->callback([flags] {
    run_check(*flags);
  });
}

}  // namespace palpate
