#include "runtime/render/rendered_body.h"

#include <fmt/format.h>

#include "formats/base/error.h"

namespace palpate {

void throw_no_element(const ArrivalRecord& arrival) {
  throw FormatError(
      fmt::format("recording: triangle {} arrived for contact {} before tick {}, which "
                  "the database does not have",
                  arrival.triangle, arrival.contact, arrival.tick));
}

}  // namespace palpate
