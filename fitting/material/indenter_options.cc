#include "fitting/material/indenter_options.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "formats/base/error.h"

namespace palpate {
namespace {

using Shapes = std::vector<std::string_view>;

bool holds(const Shapes& shapes, const std::string& shape) {
  return std::find(shapes.begin(), shapes.end(), shape) != shapes.end();
}

// A flag, its value, and the shapes that have it.
struct ShapeFlag {
  const char* name;
  std::optional<double> value;
  Shapes shapes;
  bool needed = true;
};

void check_flag(const ShapeFlag& flag, const std::string& shape) {
  const bool belongs = holds(flag.shapes, shape);
  if (!flag.value) {
    if (belongs && flag.needed) {
      throw InputError(fmt::format("--tool {} needs its {}", shape, flag.name));
    }
  } else if (shape.empty()) {
    throw InputError(fmt::format("{} needs the tool that has it: --tool {}", flag.name,
                                 fmt::join(flag.shapes, ", ")));
  } else if (!belongs) {
    throw InputError(fmt::format("{} does not belong to --tool {}", flag.name, shape));
  } else if (!(*flag.value > 0.0 && std::isfinite(*flag.value))) {
    throw InputError(fmt::format("{} is {}, must be positive", flag.name, *flag.value));
  }
}

void check_options(const IndenterOptions& o) {
  const Shapes known(kIndenterShapes.begin(), kIndenterShapes.end() - 1);
  if (!o.shape.empty() && !holds(known, o.shape)) {
    throw InputError(fmt::format("--tool {}: is not available; available: {}", o.shape,
                                 fmt::join(known, ", ")));
  }
  for (const ShapeFlag& flag :
       {ShapeFlag{"--radius-m", o.radius_m, {"sphere", "flat-punch", "plate"}},
        ShapeFlag{"--half-angle-deg", o.half_angle_deg, {"cone"}},
        ShapeFlag{"--height-m", o.height_m, {"plate"}},
        ShapeFlag{"--thickness-m", o.thickness_m, {"sphere", "flat-punch"}, false},
        ShapeFlag{
            "--radius-sd-m", o.radius_sd_m, {"sphere", "flat-punch", "plate"}, false},
        ShapeFlag{"--half-angle-sd-deg", o.half_angle_sd_deg, {"cone"}, false},
        ShapeFlag{"--height-sd-m", o.height_sd_m, {"plate"}, false},
        ShapeFlag{
            "--thickness-sd-m", o.thickness_sd_m, {"sphere", "flat-punch"}, false},
        ShapeFlag{"--poissons-ratio-sd", o.poissons_ratio_sd, known, false}}) {
    check_flag(flag, o.shape);
  }
  if (o.thickness_sd_m && !o.thickness_m) {
    throw InputError("--thickness-sd-m needs --thickness-m");
  }
  if (o.half_angle_deg && !(*o.half_angle_deg < 90.0)) {
    throw InputError(
        fmt::format("--half-angle-deg is {}, must lie in (0, 90)", *o.half_angle_deg));
  }
  if (!(o.poissons_ratio > -1.0 && o.poissons_ratio <= 0.5)) {
    throw InputError(
        fmt::format("--poissons-ratio is {}, must lie in (-1, 0.5]", o.poissons_ratio));
  }
}

}  // namespace

Indenter indenter_of(const IndenterOptions& options) {
  check_options(options);
  Indenter indenter;
  indenter.shape = options.shape.empty() ? "unknown" : options.shape;
  indenter.radius_m = options.radius_m.value_or(0.0);
  indenter.half_angle_rad =
      options.half_angle_deg.value_or(0.0) * std::numbers::pi / 180.0;
  indenter.height_m = options.height_m.value_or(0.0);
  indenter.thickness_m = options.thickness_m.value_or(0.0);
  indenter.poissons_ratio = options.poissons_ratio;
  indenter.radius_sd_m = options.radius_sd_m.value_or(0.0);
  indenter.half_angle_sd_rad =
      options.half_angle_sd_deg.value_or(0.0) * std::numbers::pi / 180.0;
  indenter.height_sd_m = options.height_sd_m.value_or(0.0);
  indenter.thickness_sd_m = options.thickness_sd_m.value_or(0.0);
  indenter.poissons_ratio_sd = options.poissons_ratio_sd.value_or(0.0);
  return indenter;
}

}  // namespace palpate
