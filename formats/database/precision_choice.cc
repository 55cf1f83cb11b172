#include "formats/database/precision_choice.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "formats/base/durable_file.h"
#include "formats/base/error.h"
#include "formats/base/stopwatch.h"
#include "formats/database/rounded_database.h"

namespace palpate {
namespace {

constexpr int kDepths = 64;

// Sums of one quantity's relative errors.
class ErrorSum {
 public:
  void add(double exact, double coarse, double scale) {
    const double error = scale > 0.0 ? std::abs(coarse - exact) / scale : 0.0;
    largest_ = std::max(largest_, error);
    squares_ += error * error;
    ++count_;
  }
  [[nodiscard]] RelativeError result() const {
    return {largest_, count_ == 0 ? 0.0 : std::sqrt(squares_ / count_)};
  }

 private:
  double largest_ = 0.0;
  double squares_ = 0.0;
  double count_ = 0.0;
};

double largest(std::span<const double> values) {
  return *std::max_element(values.begin(), values.end());
}

// Seconds per evaluation, over every curve at a few depths in turn.
double evaluation_s(const ResponseDatabase& database) {
  constexpr std::int64_t kEvaluations = 1000000;
  const ResponseTable& table = database.tools.front();
  const double depth_max_m = table.depth_max_m();
  double sum = 0.0;  // keeps the work from being left out
  const auto start = std::chrono::steady_clock::now();
  for (std::int64_t i = 0; i < kEvaluations; ++i) {
    const double t = static_cast<double>(i % kDepths) / kDepths;
    sum += table.curve(i * 7919 % table.nodes()).at(t * depth_max_m).force_n;
  }
  const double seconds = seconds_since(start);
  return std::isfinite(sum) ? seconds / kEvaluations : 0.0;
}

PrecisionRow measure(const ResponseDatabase& database, const StorageOptions& storage,
                     const std::filesystem::path& file) {
  PrecisionRow row;
  row.storage = storage;
  ResponseDatabase stored = database;
  stored.storage = storage;
  try {
    write_database(file, stored);
  } catch (const InputError&) {
    row.possible = false;
    return row;
  }
  row.bytes = std::filesystem::file_size(file);
  const auto start = std::chrono::steady_clock::now();
  const ResponseDatabase read = read_database(file);
  row.load_s = seconds_since(start);
  row.evaluate_s = evaluation_s(read);
  compare(database, read, row);
  return row;
}

}  // namespace

void compare(const ResponseDatabase& exact, const ResponseDatabase& coarse,
             PrecisionRow& row) {
  ErrorSum force;
  ErrorSum stiffness;
  ErrorSum energy;
  for (std::size_t k = 0; k < exact.tools.size(); ++k) {
    const ResponseTable& table = exact.tools[k];
    for (std::int64_t i = 0; i < table.nodes(); ++i) {
      const CurveView a = table.curve(i);
      const CurveView b = coarse.tools[k].curve(i);
      if (a.depth_m.empty()) {
        continue;
      }
      const double stiffest = table.stiffness_max_n_per_m[static_cast<std::size_t>(i)];
      for (int j = 1; j <= kDepths; ++j) {
        const double d = a.depth_max_m() * j / kDepths;
        const ResponseSample x = a.at(d);
        const ResponseSample y = b.at(d);
        // Relative to the largest of the same curve: near the touch a force is small.
        force.add(x.force_n, y.force_n, largest(a.force_n));
        stiffness.add(x.stiffness_n_per_m, y.stiffness_n_per_m, stiffest);
        energy.add(x.energy_j, y.energy_j, largest(a.energy_j));
      }
    }
  }
  row.force = force.result();
  row.stiffness = stiffness.result();
  row.energy = energy.result();
}

std::vector<PrecisionRow> measure_precisions(const ResponseDatabase& database) {
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() /
      fmt::format("palpate-precision-{}.h5", process_id());
  std::vector<PrecisionRow> rows;
  try {
    for (const Precision precision :
         {Precision::kFloat64, Precision::kFloat32, Precision::kInt16}) {
      for (const bool compress : {false, true}) {
        rows.push_back(measure(
            database, {precision, compress, database.storage.chunk_nodes}, file));
      }
    }
  } catch (...) {
    std::error_code ignored;
    std::filesystem::remove(file, ignored);
    throw;
  }
  std::error_code ignored;
  std::filesystem::remove(file, ignored);
  return rows;
}

Precision cheapest_precision(const ResponseDatabase& database, double budget_relative) {
  constexpr double kShareOfBudget = 0.1;
  for (const Precision precision : {Precision::kInt16, Precision::kFloat32}) {
    ResponseDatabase stored = database;
    stored.storage.precision = precision;
    PrecisionRow row;
    try {
      compare(database, rounded(stored), row);
    } catch (const InputError&) {
      continue;
    }
    if (row.force.largest < kShareOfBudget * budget_relative) {
      return precision;
    }
  }
  return Precision::kFloat64;
}

double budget_relative(const ResponseDatabase& database) {
  constexpr double kNoticed = 0.07;
  double budget = 0.0;
  for (const ResponseTable& table : database.tools) {
    const double own = table.accuracy.budget_relative;
    budget = own > 0.0 && (budget == 0.0 || own < budget) ? own : budget;
  }
  return budget > 0.0 ? budget : kNoticed;
}

void choose_precision(ResponseDatabase& database, std::optional<Precision> wanted) {
  database.storage.precision =
      wanted ? *wanted : cheapest_precision(database, budget_relative(database));
}

}  // namespace palpate
