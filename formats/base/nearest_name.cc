#include "formats/base/nearest_name.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

namespace palpate {
namespace {

// Optimal string alignment: row i holds the distances of a's first i characters to
// every beginning of b.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    before = last;
    last = row;
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replace = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({replace, last[j] + 1, row[j - 1] + 1});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        row[j] = std::min(row[j], before[j - 2] + 1);
      }
    }
  }
  return row.back();
}

}  // namespace

std::string_view nearest_name(std::string_view name,
                              std::span<const std::string_view> candidates) {
  // Past any key's length more characters cannot change which one is nearest.
  const std::string_view head = name.substr(0, 256);
  const auto nearest =
      std::min_element(candidates.begin(), candidates.end(),
                       [&](std::string_view a, std::string_view b) {
                         return edit_distance(head, a) < edit_distance(head, b);
                       });
  return nearest == candidates.end() ? std::string_view{} : *nearest;
}

}  // namespace palpate
