// What a page of its own carries of a database, and what it leaves out so that it stays
// small.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "formats/database/response_database.h"
#include "formats/report/standalone_page.h"

namespace palpate {

/// Bytes that a page stays under where leaving out helps.
constexpr std::size_t kPageBytes = 3'000'000;

struct PageExport {
  std::string html;
  std::string left_out;  ///< one line, as the page says it; empty: nothing
};

/// The database as a page that presses it. A page shows and renders; it leaves out what
/// neither needs:
///
///   raw measurements and measured holds, uncertainties of samples, what solves tried
///   and why some failed; the other tools; without several contacts, how they couple
///
/// A page that would be larger than `bytes_most` keeps depths and forces as int16,
/// 1/32767 of a node's largest. One that is still larger leaves out the stored
/// displacements. No more is cut: then the page is larger.
/// @param tools one, or two for two hands; none: the only one
/// @param module palpate.wasm @param device that the page may press with
/// @throws InputError for tools that are not there, or that precision cannot hold.
[[nodiscard]] PageExport page_of(const ResponseDatabase& database,
                                 const std::string& name,
                                 const std::vector<std::string>& tools,
                                 std::span<const std::byte> module,
                                 const InversePorts& device = {},
                                 std::size_t bytes_most = kPageBytes);

}  // namespace palpate
