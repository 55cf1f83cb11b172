// Any bytes as a message of the Inverse service, a state or an event: taken within its
// ranges, or refused by name; the same however often it is read.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "runtime/inverse/inverse_message.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace palpate;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  for (const char* id : {"", "049D"}) {
    InverseState state;
    const char* why = scan_inverse_state(text, id, state);
    const bool ranged =
        !state.device.position_m ||
        state.device.position_m->cwiseAbs().maxCoeff() <= kInversePositionMaxM;
    const bool named = !state.found || !state.device.id.view().empty();
    if (why == nullptr && (!ranged || !named || (state.found && state.devices < 1))) {
      __builtin_trap();
    }
  }
  InverseEvent event;
  if (scan_inverse_event(text, event) == nullptr) {
    static_cast<void>(fault_of(event, "049D"));
  }
  static_cast<void>(inverse_version(text));
  return 0;
}
