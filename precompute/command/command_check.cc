#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/error.h"
#include "formats/base/json_text.h"
#include "formats/mesh/obj_writer.h"
#include "formats/mesh/surface_reader.h"
#include "formats/scene/scene.h"
#include "precompute/body/body_surface.h"
#include "precompute/body/scene_body.h"
#include "precompute/command/commands.h"
#include "precompute/surface/bad_faces.h"
#include "precompute/surface/repair.h"
#include "precompute/surface/surface_check.h"
#include "precompute/tets/quality_notes.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

struct CheckFlags {
  std::string mesh;
  std::string length_unit;
  std::string repair = "off";
  std::string output;
  std::string bad_faces;
  bool json = false;
};

double degrees(double angle_rad) {
  return angle_rad * 180.0 / std::numbers::pi;
}

nlohmann::json to_json(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

nlohmann::json to_json(const SurfaceReport& report) {
  nlohmann::json json{
      {"accepted", report.accepted()},
      {"verdict", report.verdict()},
      {"vertices", report.vertices},
      {"triangles", report.triangles},
      {"components", report.components},
      {"components_turned", report.components_turned},
      {"closed", report.closed()},
      {"area_m2", report.area_m2},
      {"volume_m3",
       report.has_volume() ? nlohmann::json(report.volume_m3) : nlohmann::json()},
      {"lowest_m", to_json(report.lowest_m)},
      {"extent_m", to_json(report.extent_m)},
      {"edge_mean_m", report.edge_mean_m},
      {"smallest_angle_rad", report.smallest_angle_rad},
      {"notes", quality_notes(report)}};
  for (const SurfacePart& part : report.part) {
    json["parts"].push_back({{"triangles", part.triangle.size()},
                             {"closed", part.closed},
                             {"area_m2", part.area_m2},
                             {"volume_m3", std::abs(part.volume_m3)},
                             {"middle_m", to_json(part.middle_m)},
                             {"around", part.around},
                             {"cavity", part.is_cavity()},
                             {"speck", part.speck}});
  }
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

const char* kind_of(const SurfacePart& part) {
  if (part.speck) {
    return ": a speck";
  }
  if (part.is_cavity()) {
    return ": a cavity";
  }
  return part.around > 0 ? ": in a cavity" : "";
}

// Of an open surface, or of triangles turned against each other, there is none.
std::string volume_text(const SurfaceReport& report) {
  return report.has_volume() ? fmt::format("{:.6g}", report.volume_m3) : "unknown";
}

// The largest first, as far as a screen goes.
void print_parts(const SurfaceReport& report) {
  constexpr std::size_t kMost = 8;
  std::vector<const SurfacePart*> parts;
  for (const SurfacePart& part : report.part) {
    parts.push_back(&part);
  }
  std::stable_sort(parts.begin(), parts.end(),
                   [](const SurfacePart* a, const SurfacePart* b) {
                     return a->area_m2 > b->area_m2;
                   });
  for (std::size_t i = 0; i < std::min(kMost, parts.size()); ++i) {
    const SurfacePart& part = *parts[i];
    fmt::print("    part {:<16} {} triangles, {}, about {} m{}\n", i + 1,
               part.triangle.size(),
               part.closed ? fmt::format("{:.4g} m^3", std::abs(part.volume_m3))
                           : fmt::format("open, {:.4g} m^2", part.area_m2),
               place_text(part.middle_m), kind_of(part));
  }
  if (parts.size() > kMost) {
    fmt::print("    and {} smaller ones\n", parts.size() - kMost);
  }
}

void print_table(const SurfaceReport& report) {
  const Eigen::Vector3d& size_m = report.extent_m;
  fmt::print("  vertices              {}\n", report.vertices);
  fmt::print("  triangles             {}\n", report.triangles);
  fmt::print("  parts                 {}\n", report.components);
  if (report.components > 1) {
    print_parts(report);
  }
  fmt::print("  lowest corner [m]     {:.6g}, {:.6g}, {:.6g}\n", report.lowest_m.x(),
             report.lowest_m.y(), report.lowest_m.z());
  fmt::print("  size [m]              {:.6g} x {:.6g} x {:.6g}\n", size_m.x(),
             size_m.y(), size_m.z());
  fmt::print("  area [m^2]            {:.6g}\n", report.area_m2);
  fmt::print("  volume [m^3]          {}\n", volume_text(report));
  fmt::print("  mean edge [m]         {:.4g}\n", report.edge_mean_m);
  fmt::print("  smallest angle        {:.2f} deg\n",
             degrees(report.smallest_angle_rad));
  for (const DefectKind& kind : defect_kinds()) {
    fmt::print("  {:<22}{}\n", kind.key, (report.*kind.defect).count);
  }
  for (const std::string& note : quality_notes(report)) {
    fmt::print("  note                  {}\n", note);
  }
}

nlohmann::json to_json(const RepairReport& report) {
  nlohmann::json json = to_json(report.after);
  json["before"] = to_json(report.before);
  json["changed"] = nlohmann::json::array();
  for (const RepairStep& step : report.changed) {
    json["changed"].push_back({{"what", step.what}, {"count", step.count}});
  }
  json["original_vertex"] = report.original_vertex;
  json["displaced_m"] = report.displaced_m;
  json["volume_relative"] = nullptr;
  if (std::isfinite(report.volume_relative)) {
    json["volume_relative"] = report.volume_relative;
  }
  json["refusal"] = report.refusal;
  return json;
}

// What was changed, and each defect before and after.
void print_repair(const RepairReport& report) {
  for (const RepairStep& step : report.changed) {
    fmt::print("  changed               {} {}\n", step.count, step.what);
  }
  fmt::print("  {:<22}{:>12}{:>12}\n", "", "before", "after");
  const auto row = [](const char* what, const auto& before, const auto& after) {
    fmt::print("  {:<22}{:>12}{:>12}\n", what, before, after);
  };
  row("vertices", report.before.vertices, report.after.vertices);
  row("triangles", report.before.triangles, report.after.triangles);
  row("parts", report.before.components, report.after.components);
  row("volume [m^3]", volume_text(report.before), volume_text(report.after));
  for (const DefectKind& kind : defect_kinds()) {
    row(kind.key, (report.before.*kind.defect).count,
        (report.after.*kind.defect).count);
  }
  const auto kept = std::count_if(report.original_vertex.begin(),
                                  report.original_vertex.end(), [](std::int32_t v) {
                                    return v >= 0;
                                  });
  fmt::print("  vertices kept         {}, new {}\n", kept,
             std::ssize(report.original_vertex) - kept);
  fmt::print("  moved by              {:.3g} m at most", report.displaced_m);
  if (std::isfinite(report.volume_relative)) {
    fmt::print(", volume {:+.2f} %", 100.0 * report.volume_relative);
  }
  fmt::print("\n");
}

// The end of a refusal: the command that works.
std::string next_step(const CheckFlags& flags, RepairMode works) {
  std::string advice = repair_advice(works);
  if (works != RepairMode::kOff) {
    advice += fmt::format(
        ": palpate-precompute check {} --length-unit {} --repair={} -o repaired.obj",
        flags.mesh, flags.length_unit, works == RepairMode::kSafe ? "safe" : "wrap");
  }
  return advice;
}

void write_files(const CheckFlags& flags, const SurfaceMesh& mesh,
                 const RepairedSurface& repaired) {
  if (!flags.bad_faces.empty()) {
    write_bad_faces(mesh, bad_faces(mesh), flags.bad_faces);
  }
  if (!flags.output.empty() && repaired.report.refusal.empty()) {
    write_obj(repaired.mesh, flags.output,
              fmt::format("made by palpate-precompute check {} --repair={}", flags.mesh,
                          flags.repair));
  }
}

// What a build would refuse before it works, and what it would say.
void check_scene(const Scene& scene, RepairMode mode, bool json) {
  const BodySource body = read_body(scene, mode);
  const auto nodes = reachable_vertices(scene, body).size();
  for (const std::string& note : body.notes) {
    if (!json) {
      fmt::print("  note                  {}\n", note);
    }
  }
  if (!json) {
    fmt::print("  nodes in reach        {}\n", nodes);
  }
}

// What the unit may be: the file's numbers, as lengths.
[[noreturn]] void ask_for_unit(const std::string& file) {
  const Eigen::Vector3d mm = bounding_box(read_surface(file, "mm")).sizes() * 1e3;
  throw InputError(fmt::format(
      "--length-unit is required: {} spans {:.4g} x {:.4g} x {:.4g} of a unit that it "
      "does not name; give --length-unit mm, cm, m, in, ... (with mm the longest side "
      "is {:.4g} m)",
      file, mm.x(), mm.y(), mm.z(), 1e-3 * mm.maxCoeff()));
}

void run_check(CheckFlags flags) {
  const RepairMode mode = repair_mode(flags.repair);
  const std::string given = flags.mesh;
  std::optional<Scene> scene;
  if (fs::path(given).extension() == ".toml") {
    scene = read_scene(given);
    flags.mesh = scene->mesh.string();
    flags.length_unit = scene->length_unit;
  }
  if (flags.length_unit.empty()) {
    ask_for_unit(flags.mesh);
  }
  std::vector<std::string> notes;
  const SurfaceMesh mesh = scene ? read_body_mesh(*scene, notes)
                                 : read_surface(flags.mesh, flags.length_unit, &notes);
  tell_if_large(mesh, flags.mesh);
  const RepairedSurface repaired = repair_surface(mesh, mode);
  const RepairReport& report = repaired.report;
  const bool failed = !report.refusal.empty() && mode != RepairMode::kOff;
  const std::string verdict =
      failed ? fmt::format("repair \"{}\" failed: {}", flags.repair, report.refusal)
             : report.after.verdict();
  if (flags.json) {
    fmt::print("{}\n", json_text(to_json(report), 2));
  } else {
    fmt::print("{}: {}\n", flags.mesh, verdict);
    print_table(report.after);
    for (const std::string& note : notes) {
      fmt::print("  note                  {}\n", note);
    }
    if (mode != RepairMode::kOff && !report.before.accepted()) {
      print_repair(report);
    }
  }
  write_files(flags, mesh, repaired);
  if (!report.refusal.empty()) {
    throw InputError(fmt::format("{}: {}; {}", flags.mesh, verdict,
                                 next_step(flags, working_repair(mesh, mode))));
  }
  if (scene) {
    check_scene(*scene, mode, flags.json);
  }
}

}  // namespace

void add_check_command(Command app) {
  const auto flags = std::make_shared<CheckFlags>();
  Command command =
      app.add_subcommand("check", "Reports whether a surface mesh bounds a body");
  command
      .add_option(
          "mesh", flags->mesh,
          "OBJ, STL, PLY or OFF file, or a scene: then what holds its body, and "
          "its parts, are checked, too")
      .required();
  command.add_option("--length-unit", flags->length_unit,
                     "unit of the mesh file's coordinates: m, cm, mm, um, in, ...");
  command
      .add_option("--repair", flags->repair,
                  "safe: mend, no vertex moves, the surface by at most 1 % of "
                  "its diagonal; wrap: close all holes, and a new surface around")
      .one_of({"off", "safe", "wrap"})
      .show_default();
  command.add_option("-o,--output", flags->output,
                     "OBJ file to write the accepted surface to, in metres");
  command.add_option("--bad-faces", flags->bad_faces,
                     "PLY file to write the faulty triangles to, coloured by fault");
  command.add_flag("--json", flags->json, "print the report for programs");
  command.callback([flags] {
    run_check(*flags);
  });
}

}  // namespace palpate
