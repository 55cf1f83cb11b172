#include "fitting/command/lateral_file.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "fitting/numerics/robust_statistics.h"
#include "formats/base/error.h"

namespace palpate {
namespace {

constexpr double kGoesOn = 0.05;  // [-] of the travel, and of the normal force

MeasurementFile read_samples(const InstrumentLayout& layout, const std::string& file,
                             const InstrumentCurve& curve, InstrumentRequest request) {
  try {
    return layout.read(file, curve, request);
  } catch (const Error&) {
    if (request.given.time) {
      throw;  // times that were asked for
    }
  }
  request.with_time = false;  // times that nobody asked for may be no numbers
  try {
    return layout.read(file, curve, request);
  } catch (const InputError& error) {
    if (!request.given.depth.column.empty() && !request.given.force.column.empty()) {
      throw;
    }
    throw InputError(
        fmt::format("{} (--displacement-column, --displacement-unit, --force-column, "
                    "--force-unit, --normal-force-column)",
                    error.what()));
  }
}

bool goes_on(const LateralRun& before, const LateralRun& after) {
  const double travel =
      std::max(extent(before.displacement_m), extent(after.displacement_m));
  const double step = after.displacement_m.front() - before.displacement_m.back();
  const double normal = median(before.normal_n), next = median(after.normal_n);
  return std::abs(step) <= kGoesOn * travel &&
         before.normal_n.empty() == after.normal_n.empty() &&
         before.time_s.empty() == after.time_s.empty() &&
         !(std::abs(next - normal) > kGoesOn * std::abs(normal));
}

void append(const std::vector<double>& more, std::vector<double>& values) {
  values.insert(values.end(), more.begin(), more.end());
}

void take_run(LateralRun run, std::vector<LateralRun>& runs) {
  if (runs.empty() || !goes_on(runs.back(), run)) {
    runs.push_back(std::move(run));
    return;
  }
  LateralRun& last = runs.back();
  append(run.displacement_m, last.displacement_m);
  append(run.force_n, last.force_n);
  append(run.time_s, last.time_s);
  append(run.normal_n, last.normal_n);
  append(run.across_m, last.across_m);
  append(run.across_n, last.across_n);
}

}  // namespace

LateralFile read_lateral_file(const std::string& file, const MeasurementColumns& given,
                              HeaderUnits header_units) {
  const InstrumentLayout& layout = layout_of(file);
  LateralFile read;
  read.layout = layout.name;
  for (const InstrumentCurve& curve : layout.list(file).curve) {
    MeasurementFile table =
        read_samples(layout, file, curve, {given, header_units, true});
    LateralRun run;
    run.displacement_m = std::move(table.samples.depth_m);
    run.force_n = std::move(table.samples.force_n);
    run.time_s = std::move(table.samples.time_s);
    run.normal_n = std::move(table.normal_n);
    run.across_m = std::move(table.across_m);
    run.across_n = std::move(table.across_n);
    take_run(std::move(run), read.run);
    read.displacement_column = table.depth_column;
    read.force_column = table.force_column;
    read.normal_column = table.normal_column;
    for (const std::string& note : table.notes) {
      if (std::find(read.notes.begin(), read.notes.end(), note) == read.notes.end()) {
        read.notes.push_back(note);
      }
    }
  }
  for (std::size_t i = 0; i < read.run.size(); ++i) {
    read.run[i].name = read.run.size() == 1 ? file : fmt::format("{}#{}", file, i + 1);
  }
  return read;
}

}  // namespace palpate
