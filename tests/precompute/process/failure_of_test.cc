#include "precompute/process/failure_of.h"

#include <new>
#include <stdexcept>

#include <gtest/gtest.h>

#include "formats/base/error.h"

namespace palpate {
namespace {

TEST(FailureOf, WhatIsThrownBecomesASentenceThatIsNeverEmpty) {
  EXPECT_EQ(failure_of("its press", [] {}), "");
  EXPECT_EQ(failure_of("its press",
                       [] {
                         throw NumericalError("the floor fell in");
                       }),
            "the floor fell in");
  EXPECT_EQ(failure_of("its press",
                       [] {
                         throw std::runtime_error("");
                       }),
            "its press ended by an exception that says nothing");
  EXPECT_EQ(failure_of("its press",
                       [] {
                         throw 7;
                       }),
            "its press ended by an unknown exception");
}

TEST(FailureOf, AWantThatPassesIsNotItsFault) {
  const auto thrown = [](auto&& want) -> std::string {
    try {
      (void)failure_of("its press", [&] {
        throw want;
      });
    } catch (const ResourceError& error) {
      return error.what();
    }
    return "nothing";
  };
  EXPECT_EQ(thrown(ResourceError("no room")), "no room");
  EXPECT_EQ(thrown(std::bad_alloc()), "its press needed more memory than there is");
}

TEST(FailureOf, AnInterruptGoesOn) {
  EXPECT_THROW((void)failure_of("its press",
                                [] {
                                  throw Interrupted();
                                }),
               Interrupted);
}

}  // namespace
}  // namespace palpate
