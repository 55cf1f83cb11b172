#include "fitting/command/estimate_text.h"

#include <cmath>
#include <span>

#include <fmt/format.h>

#include "formats/base/atomic_file.h"

namespace palpate {

void print_estimate(const std::string& name, const IntervalEstimate& estimate,
                    const std::string& unit) {
  if (!estimate.refused.empty()) {
    const std::string above =
        std::isfinite(estimate.above)
            ? fmt::format("; above {:.4g} {}", estimate.above, unit)
            : std::string();
    fmt::print("{:<24} none: {}{}\n", name, estimate.refused, above);
    return;
  }
  const std::string spread = fmt::format(" +- {:.2g}", estimate.sd);
  fmt::print("{:<24} {:>13.6g}{:<10} {:<6} [{:.5g}, {:.5g}]\n", name, estimate.value,
             spread, unit, estimate.low, estimate.high);
}

std::string joined_names(const std::vector<std::string>& files) {
  std::string names;
  for (const std::string& file : files) {
    names += (names.empty() ? "" : ", ") + file;
  }
  return names;
}

void write_scene_part(const std::string& text, const std::string& file) {
  AtomicFile atomic(file);
  atomic.write(std::as_bytes(std::span(text)));
  atomic.commit();
}

}  // namespace palpate
