// What each way of storing a database costs and loses.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "formats/database/response_database.h"

namespace palpate {

/// Largest and rms error of one quantity against float64, over all curves at 64 depths
/// each; relative to the largest value of the same curve.
struct RelativeError {
  double largest = 0.0;
  double rms = 0.0;
};

struct PrecisionRow {
  StorageOptions storage;
  std::uintmax_t bytes = 0;
  double load_s = 0.0;      ///< [s] to read and check the whole file
  double evaluate_s = 0.0;  ///< [s] per evaluation of a curve, from memory
  RelativeError force;
  RelativeError stiffness;
  RelativeError energy;
  bool possible = true;  ///< false: this precision cannot hold the database
};

/// Errors of `coarse` against `exact`, tables of the same nodes.
void compare(const ResponseDatabase& exact, const ResponseDatabase& coarse,
             PrecisionRow& row);

/// Writes the database in every way to a folder for temporary files, and reads it back.
[[nodiscard]] std::vector<PrecisionRow> measure_precisions(
    const ResponseDatabase& database);

/// The smallest precision whose largest error of force is under a tenth of the budget
/// (relative force error); float64 if none is. Nothing is written.
[[nodiscard]] Precision cheapest_precision(const ResponseDatabase& database,
                                           double budget_relative);

/// The smallest accuracy budget that the database's tools state (relative force error);
/// 0.07, what people notice, where none does.
[[nodiscard]] double budget_relative(const ResponseDatabase& database);

/// Sets the precision that the database is to be written with: the one that a user
/// asks for, else the cheapest for its own budget.
void choose_precision(ResponseDatabase& database, std::optional<Precision> wanted);

}  // namespace palpate
