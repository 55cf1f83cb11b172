#include "formats/stored/stored_type.h"

#include <gtest/gtest.h>

namespace palpate {
namespace {

TEST(StoredTypes, ShapesCountTheirValues) {
  EXPECT_EQ(values_in({5}), 5U);
  EXPECT_EQ(values_in({5, 3}), 15U);
  EXPECT_EQ(values_in({5, 3, 2}), 30U);
  EXPECT_EQ(values_in({0, 3}), 0U);
  EXPECT_EQ(columns_of({5}), 0);
  EXPECT_EQ(columns_of({5, 1}), 1);
  EXPECT_EQ(columns_of({0, 3}), 3);
  EXPECT_EQ(columns_of({5, 3, 2}), 6);
}

}  // namespace
}  // namespace palpate
