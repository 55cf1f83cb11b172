// The force of a body's stored potential field at places without history. The local
// model "potential" (runtime/fast/potential_field.h), or "facets", gives that force at
// a place that the tool has just reached. The force is without friction, dents and
// relaxed state.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "formats/database/response_database.h"
#include "runtime/account/local_model.h"
#include "runtime/slow/memory_elements.h"

namespace palpate {

class StaticField {
 public:
  /// Both must outlive the field; `table` belongs to the database.
  /// @throws InputError for a body that yields: its force depends on what was pressed.
  StaticField(const ResponseDatabase& database, const ResponseTable& table,
              FieldKind kind = FieldKind::kSmooth);

  /// Forces on the tool [N], (n x 3). May run in several threads. A position's force
  /// depends neither on the others nor on the number of threads.
  /// @param position_m (n x 3) [m] of the tool's reference point, in the body's frame.
  /// @throws InputError naming the first position that is not finite.
  [[nodiscard]] Points force_n(const Eigen::Ref<const Points>& position_m) const;

  /// The same into (n x 3) `into_n`, which may be the positions' own memory.
  /// @param threads at most; 0: as many as there are processors.
  void force_n(const Eigen::Ref<const Points>& position_m, Eigen::Ref<Points> into_n,
               unsigned threads) const;

 private:
  class Place;

  ElementStream stream_;
  double radius_m_;
  FieldKind kind_;
};

/// The force of the smooth field of a database's tool of that index, as force_n().
[[nodiscard]] Points stored_forces(const ResponseDatabase& database, std::size_t tool,
                                   const Points& position_m);

}  // namespace palpate
