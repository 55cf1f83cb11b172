// The trade study as one HTML page that needs nothing else.
#pragma once

#include <string>
#include <vector>

#include "runtime/bench/bench_rate_trade.h"

namespace palpate {

/// Largest stable stiffness, force error, net energy and processor time over the slow
/// rate, as a plot and a table. There is a line per local model, for the device, wall
/// and fast rate that are chosen on the page. The page asks for nothing from elsewhere,
/// and forbids itself to. @param rows at least one.
[[nodiscard]] std::string trade_page(const std::vector<RateTradeRow>& rows);

}  // namespace palpate
