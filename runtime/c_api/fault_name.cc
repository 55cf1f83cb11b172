// palpate_fault_name() of the C interface.
#include <cstdint>
#include <limits>

#include "runtime/account/safety.h"
#include "runtime/c_api/palpate.h"

const char* palpate_fault_name(int status) {
  switch (status) {
    case PALPATE_FREE:
      return "free";
    case PALPATE_CONTACT:
      return "contact";
    case PALPATE_ERROR_INTERNAL:
      return "internal-error";
    case PALPATE_ERROR_INPUT:
      return "input-error";
    case PALPATE_ERROR_FORMAT:
      return "format-error";
    default:
      break;
  }
  const bool fault = status < 0 && status >= -std::numeric_limits<std::uint8_t>::max();
  // The names are literals, which end in a zero.
  return fault ? palpate::name(static_cast<palpate::Fault>(-status)).data() : "unknown";
}
