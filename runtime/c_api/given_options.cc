#include "runtime/c_api/given_options.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>

#include <fmt/format.h>

#include "formats/base/error.h"

namespace palpate {
namespace {

// The caller's options, whatever the age of the header it knows. A longer struct may
// only say what this library understands: zeros.
palpate_options known_options(const palpate_options* given) {
  palpate_options all{};
  if (given == nullptr) {
    return all;
  }
  if (given->struct_size < offsetof(palpate_options, tool_name)) {
    throw InputError(
        fmt::format("struct_size of the options is {}, must be sizeof(palpate_options)",
                    given->struct_size));
  }
  const auto* bytes = reinterpret_cast<const unsigned char*>(given);
  for (std::size_t i = sizeof(all); i < given->struct_size; ++i) {
    if (bytes[i] != 0) {
      throw InputError(
          fmt::format("byte {} of the options is set, this library (ABI {}) knows {}",
                      i, PALPATE_ABI_VERSION, sizeof(all)));
    }
  }
  std::memcpy(&all, given, std::min(given->struct_size, sizeof(all)));
  return all;
}

void take(double value, double& into) {
  if (value != 0.0) {  // NaN is taken, and refused with the rest
    into = value;
  }
}

}  // namespace

HostOptions host_options(const palpate_options* given) {
  const palpate_options all = known_options(given);
  HostOptions options;
  if (all.tool_name != nullptr) {
    options.tool = all.tool_name;
  }
  if (all.model != nullptr) {
    options.model = passive_model(all.model);
  }
  take(all.metres_per_unit, options.metres_per_unit);
  take(all.newtons_per_unit, options.newtons_per_unit);
  take(all.position_gain, options.position_gain);
  take(all.force_gain, options.force_gain);
  take(all.nominal_tick_s, options.tick_s);
  take(all.slow_hz, options.slow_hz);
  take(all.device_damping_n_s_per_m, options.damping_n_s_per_m);
  take(all.device_angular_damping_n_m_s, options.angular_damping_n_m_s);
  take(all.device_delay_s, options.delay_s);
  take(all.force_max_n, options.force_max_n);
  take(all.stall_s, options.stall_s);
  take(all.ramp_s, options.ramp_s);
  constexpr std::uint32_t kKnown = PALPATE_OWN_SLOW_STEPS | PALPATE_LIMIT_STIFFNESS |
                                   PALPATE_STREAMED | PALPATE_SCENE | PALPATE_ESTIMATE |
                                   PALPATE_FORCES_ALONE;
  if ((all.flags & ~kKnown) != 0) {
    throw InputError(
        fmt::format("flags are {:#x}, known are {:#x}", all.flags, kKnown));
  }
  options.own_slow_steps = (all.flags & PALPATE_OWN_SLOW_STEPS) != 0;
  options.limit_stiffness = (all.flags & PALPATE_LIMIT_STIFFNESS) != 0;
  options.streamed = (all.flags & PALPATE_STREAMED) != 0;
  options.scene = (all.flags & PALPATE_SCENE) != 0;
  options.forces_alone = (all.flags & PALPATE_FORCES_ALONE) != 0;
  options.estimate = (all.flags & PALPATE_ESTIMATE) != 0;
  options.server = all.server == nullptr ? "" : all.server;
  options.output = all.output == nullptr ? "" : all.output;
  return options;
}

}  // namespace palpate
