// What a session's page says of the machine, of cycles and of means.
#pragma once

#include <string>

#include "fitting/session/batch.h"

namespace palpate {

/// HTML: the frame, the registration, a table of the presses of files with several, a
/// table of the mean curves at their largest depth. Empty where there is none of it.
[[nodiscard]] std::string batch_summary(const Session& session,
                                        const BatchReport& report);

}  // namespace palpate
