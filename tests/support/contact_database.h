// A small database that knows pressures and lateral stiffnesses.
#pragma once

#include "tests/support/small_database.h"

namespace palpate {

/// The first tool with contacts at five of its six nodes.
inline ResponseDatabase with_contacts() {
  ResponseDatabase database = small_database();
  ContactTable& contact = database.tools.front().contact;
  contact.centre_m = RowsOf<float>::Zero(6, 8);
  contact.moment_m2 = RowsOf<float>::Zero(6, 12);
  contact.exponent = RowsOf<float>::Zero(6, 4);
  contact.pressure_error = RowsOf<float>::Zero(6, 1);
  contact.lateral = RowsOf<float>::Zero(6, 12);
  contact.lateral_error = RowsOf<float>::Zero(6, 1);
  for (Eigen::Index i = 0; i < 5; ++i) {
    for (Eigen::Index k = 0; k < 4; ++k) {
      const auto grows = static_cast<float>(1 + i + k);
      contact.centre_m(i, 2 * k) = 1e-4F * grows;
      contact.moment_m2.block<1, 3>(i, 3 * k) << 2e-6F * grows, 1e-7F, 1e-6F * grows;
      contact.exponent(i, k) = 0.5F;
      contact.lateral.block<1, 3>(i, 3 * k) << 1.0F + 0.1F * grows, 0.1F, 1.0F;
    }
    contact.lateral_error(i, 0) = 0.02F * static_cast<float>(i);
  }
  return database;
}

}  // namespace palpate
