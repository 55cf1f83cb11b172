// What a host says in palpate_options (palpate.h), as the library's own options.
#pragma once

#include "runtime/c_api/host_tool.h"
#include "runtime/c_api/palpate.h"

namespace palpate {

/// Zeros are defaults; not checked for ranges (check() of host_tool.h). @param given
/// may be null, of an older or a newer header. @throws InputError for what this library
/// does not understand: size, flags, model.
[[nodiscard]] HostOptions host_options(const palpate_options* given);

}  // namespace palpate
