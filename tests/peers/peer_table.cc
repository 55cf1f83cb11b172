#include "tests/peers/peer_table.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <fmt/format.h>

#include "formats/report/log_plot.h"

namespace palpate::peers {
namespace {

std::string number(double value, const char* format) {
  return std::isfinite(value) ? fmt::format(fmt::runtime(format), value) : "-";
}

std::string percent(double value) {
  return number(100.0 * value, "{:.1f} %");
}

std::string degrees(double rad) {
  return number(rad * 180.0 / std::numbers::pi, "{:.2f}");
}

std::string stiffness(const StableStiffness& s) {
  return (s.at_end ? "> " : "") + number(s.stiffness_n_per_m, "{:.0f}");
}

std::string bytes(std::uintmax_t count) {
  return count == 0 ? "0" : number(static_cast<double>(count) / 1e6, "{:.2f}");
}

// Energies below this are of the quadrature along the path, and no finding.
std::string micro_joule(double joule) {
  return joule < 1e-6 ? "< 1" : number(1e6 * joule, "{:.0f}");
}

std::string smoothness(const PeerRow& r) {
  const Roughness rough = roughness(r.sideways);
  return fmt::format(
      "{}, {} | {}, {} | {} | {}, {} | {}", percent(r.jumps.relative),
      percent(r.jumps.anywhere_relative), degrees(r.jumps.turn_rad),
      degrees(r.jumps.turn_anywhere_rad), number(1e3 * r.jumps.largest_n, "{:.2f}"),
      number(1e3 * rough.rendered_n, "{:.2f}"), number(1e3 * rough.true_n, "{:.2f}"),
      number(rough.ratio, "{:.1f}"));
}

std::string markdown_row(const PeerRow& r) {
  std::string text = fmt::format(
      "| {} | {} | {} | {} | {} | {} | {} | {} |", r.renderer,
      number(1e3 * r.error.contact_mean_n, "{:.1f}"), percent(r.error.contact_relative),
      percent(r.error.along_relative), smoothness(r), micro_joule(r.created_path_j),
      micro_joule(r.lost_path_j), micro_joule(r.created_cycle_j));
  std::string stable;
  for (const StableStiffness& s : r.stable) {
    stable += (stable.empty() ? "" : ", ") + stiffness(s);
  }
  return text + fmt::format(" {} | {} | {} | {} | {} | {} | {} |\n",
                            stable.empty() ? "-" : stable,
                            number(r.time.median_us, "{:.2f}"),
                            number(r.time.p999_us, "{:.1f}"),
                            number(r.time.slow_median_us, "{:.1f}"),
                            number(r.time.allocations, "{:.3g}"),
                            number(r.build_s, "{:.1f}"), bytes(r.bytes));
}

// Thirds of an octave as far as they are whole.
LogSeries bands(const std::string& name, const MeanSquares& all, double dot_px) {
  constexpr double kFirstHz = 2.5;  // lower ones may lie between two frequencies
  constexpr double kLeastN = 1e-6;
  LogSeries series{name, {}, true};
  const double half = std::exp2(1.0 / 6.0);
  const double end_hz = static_cast<double>(all.mean_squares.size() + 1) * all.step_hz;
  for (double hz = kFirstHz; hz * half <= end_hz; hz *= half * half) {
    const double rms_n = std::max(kLeastN, all.rms(hz / half, hz * half));
    series.point.push_back({hz, 1e3 * rms_n, dot_px, {}});
  }
  return series;
}

}  // namespace

std::vector<std::string> scenes_of(std::span<const PeerRow> rows) {
  std::vector<std::string> names;
  for (const PeerRow& row : rows) {
    if (std::find(names.begin(), names.end(), row.scene) == names.end()) {
      names.push_back(row.scene);
    }
  }
  return names;
}

std::string table_markdown(std::span<const PeerRow> rows) {
  std::string text;
  for (const std::string& scene : scenes_of(rows)) {
    text += fmt::format(
        "\n**{}**\n\n| renderer | off by [mN] | in contact | along | jump at an edge, "
        "anywhere | turn at an edge, anywhere [°] | jump at an edge [mN] | sideways "
        "from "
        "5 Hz on, true [mN] | roughness | "
        "created [µJ] | lost [µJ] | created in a cycle [µJ] | stable up to [N/m] | "
        "step "
        "[µs] | p99.9 [µs] | slow turn [µs] | allocations | build [s] | disk [MB] "
        "|\n|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|--"
        "-|\n",
        scene);
    std::string missing;
    for (const PeerRow& row : rows) {
      if (row.scene != scene || row.renderer == "truth") {
        continue;
      }
      (row.missing.empty() ? text : missing) +=
          row.missing.empty() ? markdown_row(row)
                              : fmt::format("\n- {}: {}", row.renderer, row.missing);
    }
    text += missing.empty() ? "" : "\nNot there:" + missing + "\n";
  }
  return text;
}

std::string nodule_markdown(std::span<const PeerRow> rows) {
  std::string text =
      "\n| scene | renderer | found | distance [mm] | false finds | largest deviation "
      "|\n|---|---|---|---|---|---|\n";
  for (const PeerRow& r : rows) {
    if (r.nodule) {
      text +=
          fmt::format("| {} | {} | {} | {} | {} | {} |\n", r.scene, r.renderer,
                      std::isnan(r.nodule->distance_m) && !r.nodule->found ? "nothing"
                      : r.nodule->found                                    ? "yes"
                                        : "elsewhere",
                      number(1e3 * r.nodule->distance_m, "{:.1f}"),
                      r.nodule->false_finds, percent(r.nodule->largest_deviation));
    }
  }
  return text;
}

std::string table_csv(std::span<const PeerRow> rows) {
  std::string text =
      "scene,renderer,missing,truth_points,contact_points,error_n,error_relative,"
      "contact_error_n,contact_error_relative,contact_error_along_relative,edges,"
      "jump_largest_n,jump_mean_n,jump_relative,jump_anywhere_relative,turn_rad,"
      "turn_anywhere_rad,rough_n,true_rough_n,roughness,created_path_j,"
      "lost_path_j,"
      "created_cycle_j,cycle_j,stable_pencat_n_per_m,stable_falcon_n_per_m,"
      "rest_n_per_m,step_median_us,step_p999_us,slow_median_us,allocations,build_s,"
      "bytes,nodule_found,nodule_distance_m,nodule_false_finds,largest_deviation,"
      "digest\n";
  for (const PeerRow& r : rows) {
    const StableStiffness none{std::nan(""), false, std::nan("")};
    const StableStiffness& pencat = !r.stable.empty() ? r.stable[0] : none;
    const StableStiffness& falcon = r.stable.size() > 1 ? r.stable[1] : none;
    const NoduleFind nodule = r.nodule.value_or(NoduleFind{});
    const Roughness rough = roughness(r.sideways);
    text += fmt::format(
        "{},\"{}\",\"{}\",{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{"
        "}",
        r.scene, r.renderer, r.missing, r.error.points, r.error.contact_points,
        r.error.mean_n, r.error.relative, r.error.contact_mean_n,
        r.error.contact_relative, r.error.along_relative, r.jumps.edges,
        r.jumps.largest_n, r.jumps.mean_n, r.jumps.relative, r.jumps.anywhere_relative,
        r.jumps.turn_rad, r.jumps.turn_anywhere_rad, rough.rendered_n, rough.true_n,
        rough.ratio, r.created_path_j, r.lost_path_j, r.created_cycle_j, r.cycle_j);
    text += fmt::format(",{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n",
                        pencat.stiffness_n_per_m, falcon.stiffness_n_per_m,
                        pencat.rest_n_per_m, r.time.median_us, r.time.p999_us,
                        r.time.slow_median_us, r.time.allocations, r.build_s, r.bytes,
                        static_cast<int>(nodule.found), nodule.distance_m,
                        nodule.false_finds, nodule.largest_deviation, r.digest);
  }
  return text;
}

std::string table_picture(std::span<const PeerRow> rows) {
  LogPicture picture{
      .title = "What a step costs, and how far the force is off",
      .subtitle = "a point for each scene; in contact, over the true force",
      .x_name = "median time of a step [us]",
      .y_name = "error of force [-]",
      .series = {},
      .level_name = {}};
  for (const PeerRow& row : rows) {
    if (!row.missing.empty() || row.renderer == "truth") {
      continue;
    }
    auto series = std::find_if(picture.series.begin(), picture.series.end(),
                               [&](const LogSeries& s) {
                                 return s.name == row.renderer;
                               });
    if (series == picture.series.end()) {
      picture.series.push_back({row.renderer, {}, false});
      series = std::prev(picture.series.end());
    }
    series->point.push_back({row.time.median_us, row.error.contact_relative, 4.0, {}});
  }
  return log_picture(picture);
}

std::string spectrum_picture(std::span<const PeerRow> rows, const std::string& scene) {
  LogPicture picture{.title = fmt::format("The sideways force of a slide: {}", scene),
                     .subtitle =
                         "at 20 mm/s, without friction; rms in thirds of an octave; "
                         "0.001 is that or less",
                     .x_name = "frequency [Hz]",
                     .y_name = "sideways force [mN]",
                     .series = {},
                     .level_name = {}};
  for (const PeerRow& row : rows) {
    if (row.scene != scene || row.sideways.truth.mean_squares.empty() ||
        row.renderer.ends_with("friction")) {
      continue;
    }
    if (picture.series.empty()) {
      picture.series.push_back(bands("truth", row.sideways.truth, 6.0));
    }
    picture.series.push_back(bands(row.renderer, row.sideways.rendered, 3.0));
  }
  return picture.series.empty() ? std::string() : log_picture(picture);
}

}  // namespace palpate::peers
