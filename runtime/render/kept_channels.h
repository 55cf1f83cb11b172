// Channels of needles from one run to the next.
#pragma once

#include <vector>

#include "formats/recording/kept_surface.h"
#include "runtime/fast/needle_step.h"

namespace palpate {

/// In the order of punctures, of table 0.
[[nodiscard]] std::vector<ChannelRow> channel_rows(const NeedleState& needle);

/// The channels take the place of the state's, with the needle in none of them.
/// @param rows as check_kept() takes them. @throws InputError for more channels than a
/// body keeps, or materials that the rules do not have; the state is as it was then.
void begin_channels(const std::vector<ChannelRow>& rows, const PunctureRules& rules,
                    NeedleState& needle);

}  // namespace palpate
