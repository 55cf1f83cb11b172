// static_field_study DATABASE POSITIONS THREADS: forces of the stored field in C++, as
// Python's Tool.force has them. POSITIONS: n x 3 doubles [m]. Prints nanoseconds per
// position, the least of some runs, and the sum of the forces' lengths.
#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>

#include <fmt/format.h>

#include "formats/base/stopwatch.h"
#include "runtime/slow/static_field.h"

namespace palpate {
namespace {

constexpr int kRuns = 5;

Points read_positions(const char* file) {
  std::ifstream in(file, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  const auto rows = static_cast<Eigen::Index>(bytes.size() / (3 * sizeof(double)));
  Points positions(rows, 3);
  std::copy_n(bytes.data(), static_cast<std::size_t>(rows) * 3 * sizeof(double),
              reinterpret_cast<char*>(positions.data()));
  return positions;
}

void measure(const char* file, const char* positions_file, unsigned threads) {
  const ResponseDatabase database = read_database(file);
  const StaticField field(database, database.tools.front());
  const Points positions = read_positions(positions_file);
  double seconds = std::numeric_limits<double>::infinity();
  Points force(positions.rows(), 3);
  for (int run = 0; run < kRuns; ++run) {
    const auto begin = std::chrono::steady_clock::now();
    field.force_n(positions, force, threads);
    seconds = std::min(seconds, seconds_since(begin));
  }
  fmt::print("{} {}\n", 1e9 * seconds / static_cast<double>(positions.rows()),
             force.rowwise().norm().sum());
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  if (argc != 4) {
    fmt::print(stderr, "static_field_study DATABASE POSITIONS THREADS\n");
    return 2;
  }
  palpate::measure(argv[1], argv[2],
                   static_cast<unsigned>(std::strtoul(argv[3], nullptr, 10)));
  return 0;
}
