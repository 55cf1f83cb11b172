#include "runtime/view/adjusted_contacts.h"

#include <vector>

#include <gtest/gtest.h>

#include "tests/support/padded_plate.h"

namespace palpate {
namespace {

// A body n times as stiff sinks by an n-th under the same force, whatever carries that.
TEST(AdjustedContacts, RowsAndModesOfAStifferBodyAreSofter) {
  ResponseDatabase database = padded_plate(2);
  ComplianceTable& table = database.tools[1].compliance;
  table.mode = RowsOf<float>::Constant(table.value.rows(), 2, 0.03F);
  table.added_modes = 1;
  const std::vector<const ResponseTable*> tools{&database.tools[1]};
  AdjustedContacts contacts(database, tools);
  const ContactElement whole = contacts.element(0, 100, true);
  contacts.set_stiffness_scale(4.0);
  contacts.set_friction(0.1);
  const ContactElement stiff = contacts.element(0, 100, true);
  const ContactElement apart = contacts.element(0, 100, false);
  for (std::size_t a = 0; a < 3; ++a) {
    EXPECT_EQ(stiff.element.node[a].friction, 0.1);
    EXPECT_EQ(stiff.element.node[a].force_n[5], 4.0 * whole.element.node[a].force_n[5]);
    for (std::size_t k = 0; k < 12; ++k) {
      EXPECT_GT(whole.row[a].value[k], 0.0F);
      EXPECT_EQ(stiff.row[a].value[k], 0.25F * whole.row[a].value[k]);
      EXPECT_EQ(apart.row[a].value[k], 0.0F);
    }
    for (std::size_t m = 0; m < 2; ++m) {
      EXPECT_EQ(whole.row[a].mode[m], 0.03F);
      EXPECT_EQ(stiff.row[a].mode[m], 0.5F * whole.row[a].mode[m]);
      EXPECT_EQ(apart.row[a].mode[m], 0.0F);
    }
  }
}

}  // namespace
}  // namespace palpate
