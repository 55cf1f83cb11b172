#include "runtime/c_api/known_struct.h"

#include <array>
#include <cstring>

#include <gtest/gtest.h>

namespace palpate {
namespace {

// As the library knows it; callers know the first one, two or three members, or more.
struct Told {
  std::size_t struct_size = 0;
  double first = 1.5;
  double second = 2.5;
};

struct NewerTold {
  Told told;
  double third = 9.0;
  double beyond = 8.0;
};

// What a caller has after it got a struct of this size.
NewerTold told_to(std::size_t struct_size) {
  NewerTold caller;
  caller.told = {struct_size, -1.0, -1.0};
  Told all;
  all.struct_size = struct_size;
  copy_known(all, &caller.told);
  return caller;
}

TEST(KnownStruct, AnOlderCallerGetsWhatItKnowsAndNoByteMore) {
  const NewerTold caller = told_to(offsetof(Told, second));
  EXPECT_EQ(caller.told.first, 1.5);
  EXPECT_EQ(caller.told.second, -1.0);
}

TEST(KnownStruct, ACallerOfThisAgeGetsAll) {
  const NewerTold caller = told_to(sizeof(Told));
  EXPECT_EQ(caller.told.struct_size, sizeof(Told));
  EXPECT_EQ(caller.told.first, 1.5);
  EXPECT_EQ(caller.told.second, 2.5);
  EXPECT_EQ(caller.third, 9.0);
}

TEST(KnownStruct, ANewerCallerGetsZerosForWhatIsNotKnownHere) {
  const NewerTold caller = told_to(offsetof(NewerTold, beyond));
  EXPECT_EQ(caller.told.second, 2.5);
  EXPECT_EQ(caller.third, 0.0);
  EXPECT_EQ(caller.beyond, 8.0);
}

}  // namespace
}  // namespace palpate
