// What a run saw of the service whose answers it rendered.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "runtime/served/growing_elements.h"
#include "runtime/served/served_client.h"

namespace palpate {

struct ServedReport {
  ServiceStatus status;                 ///< at the end
  QualityTicks ticks{};                 ///< in the body
  std::vector<QualityTicks> by_second;  ///< of them in every second
  std::int64_t softened = 0;            ///< answers that were too stiff for the device
};

/// By second, as comma-separated values: "second,none,estimated,preliminary,final",
/// shares of the ticks in the body [-]; none for a second without any.
[[nodiscard]] std::string quality_csv(const ServedReport& report);

}  // namespace palpate
