// How a scene's service is, as reported to a host (palpate.h).
#pragma once

#include "runtime/c_api/host_body.h"
#include "runtime/c_api/palpate.h"

namespace palpate {

/// Zero for a body of a database; struct_size is not set.
[[nodiscard]] palpate_service service_status(const HostBody& body);

}  // namespace palpate
