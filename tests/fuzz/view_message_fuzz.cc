// Any bytes as a message of the live view's page: decoded within its ranges, or refused
// with an Error.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "formats/base/error.h"
#include "runtime/view/view_message.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using palpate::ViewRanges;
  try {
    const palpate::ViewRequest request =
        palpate::decode_view_message({reinterpret_cast<const char*>(data), size});
    const bool target_ok =
        !(request.target_m.cwiseAbs().maxCoeff() > ViewRanges::kTargetM) &&
        request.target_m.allFinite();
    const bool rate_ok =
        !request.slow_hz || (*request.slow_hz >= ViewRanges::kSlowHzMin &&
                             *request.slow_hz <= ViewRanges::kSlowHzMax);
    const bool hand_ok =
        (!request.hand || *request.hand == 0 || *request.hand == 1) &&
        (!request.turn || std::abs(request.turn->norm() - 1.0) < 1e-12);
    if (!target_ok || !rate_ok || !hand_ok || request.node < -1) {
      __builtin_trap();
    }
  } catch (const palpate::Error&) {
  }
  return 0;
}
