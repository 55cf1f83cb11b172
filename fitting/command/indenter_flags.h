// The flags that state to a tool what pressed.
#pragma once

#include "fitting/material/indenter_options.h"
#include "formats/base/command_line.h"

namespace palpate {

/// --tool, --radius-m, --half-angle-deg, --height-m, --thickness-m, --poissons-ratio,
/// and of each but the first its standard deviation, --radius-sd-m and so on.
void add_indenter_options(Command command, IndenterOptions& options);

}  // namespace palpate
