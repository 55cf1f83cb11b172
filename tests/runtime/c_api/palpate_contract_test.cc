// What palpate.h promises beside forces: structs of other versions, ranges, reasons,
// the bound that it states, and HDF5.
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <thread>

#include "formats/base/utf8_path.h"
#include "tests/runtime/c_api/pressed_plate_host.h"

namespace palpate {
namespace {

class PalpateContract : public PressedPlateHost {};

TEST_F(PalpateContract, StructsOfOtherVersions) {
  palpate_options old = options();
  old.struct_size = offsetof(palpate_options, metres_per_unit);
  old.metres_per_unit = kNan;  // not looked at
  palpate_body* body = palpate_open(file_.c_str(), &old, error_, sizeof error_);
  EXPECT_NE(body, nullptr) << error_;
  palpate_close(body);
  struct {
    palpate_options known;
    double added;
  } newer{options(), 0.0};
  newer.known.struct_size = sizeof newer;
  EXPECT_NE(open(newer.known), nullptr) << error_;
  newer.added = 1.0;
  body = palpate_open(file_.c_str(), &newer.known, error_, sizeof error_);
  EXPECT_EQ(body, nullptr);
  palpate_close(body);
  palpate_options none{};
  EXPECT_EQ(open(none), nullptr);
  palpate_tool* tool = open(options());
  palpate_state state{};
  state.struct_size = offsetof(palpate_state, contact_point);
  state.contact_point[0] = 7.0;
  palpate_state_get(tool, &state);
  EXPECT_EQ(state.triangle, -1);
  EXPECT_EQ(state.contact_point[0], 7.0);
  EXPECT_EQ(palpate_abi_version(), PALPATE_ABI_VERSION);
}

// Windows' own names are UTF-16.
TEST_F(PalpateContract, NamesOfFilesAreUtf8) {
  const std::string name = "Leber \u00fc \u809d \U0001fac0.h5";
  const std::filesystem::path file =
      std::filesystem::path(file_).parent_path() / path_of_utf8(name);
  std::filesystem::copy_file(file_, file);
  const palpate_options all = options();
  body_ = palpate_open(utf8_of(file).c_str(), &all, error_, sizeof error_);
  EXPECT_NE(body_, nullptr) << error_;
  std::filesystem::remove(file);
  EXPECT_EQ(palpate_open(utf8_of(file).c_str(), &all, error_, sizeof error_), nullptr);
  EXPECT_NE(std::string(error_).find(name), std::string::npos) << error_;
}

TEST_F(PalpateContract, WhatANewerHeaderAddedToTheStateIsZero) {
  struct {
    palpate_state known;
    double added[4];
  } newer{};
  newer.known.struct_size = sizeof newer;
  for (double& value : newer.added) {
    value = 7.0;
  }
  palpate_tool* tool = open(options());
  palpate_state_get(tool, &newer.known);
  EXPECT_EQ(newer.known.struct_size, sizeof newer);
  for (const double value : newer.added) {
    EXPECT_EQ(value, 0.0);
  }
}

TEST_F(PalpateContract, UnitsAndGainsBeyondAllDigitsAreRefused) {
  for (double palpate_options::*const member :
       {&palpate_options::metres_per_unit, &palpate_options::newtons_per_unit,
        &palpate_options::position_gain, &palpate_options::force_gain}) {
    for (const double value : {1e-300, 1e-7, 1e7, 1e308, -1.0}) {
      palpate_options wanted = options();
      wanted.*member = value;
      EXPECT_EQ(open(wanted), nullptr) << value;
    }
  }
}

TEST_F(PalpateContract, StatesTheBoundThatItDidNotCheck) {
  palpate_options wanted = options();
  ASSERT_NE(open(wanted), nullptr) << error_;
  EXPECT_NEAR(palpate_needed_damping(body_), 1200.0 * 0.0005, 1e-6);
  wanted.position_gain = 2.0;
  wanted.device_delay_s = 0.002;
  ASSERT_NE(open(wanted), nullptr) << error_;
  EXPECT_NEAR(palpate_needed_damping(body_), 2400.0 * 0.0025, 1e-6);
  EXPECT_EQ(palpate_needed_damping(nullptr), 0.0);
}

TEST_F(PalpateContract, AHostExcludesTheLibraryFromHdf5) {
#ifdef PALPATE_WITHOUT_HDF5
  GTEST_SKIP() << "there is nothing to exclude";
#endif
  palpate_options wanted = options();
  wanted.flags = PALPATE_STREAMED;
  ASSERT_NE(open(wanted), nullptr) << error_;
  palpate_hdf5_lock();
  palpate_hdf5_lock();  // nests
  std::atomic<bool> opened = false;
  std::thread other([&] {
    palpate_body* body = palpate_open(file_.c_str(), nullptr, nullptr, 0);
    opened = true;
    palpate_close(body);
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_FALSE(opened);
  palpate_hdf5_unlock();
  palpate_hdf5_unlock();
  other.join();
  EXPECT_TRUE(opened);
}

TEST_F(PalpateContract, FailuresToOpenSayWhy) {
  EXPECT_EQ(palpate_open("absent.h5", nullptr, error_, sizeof error_), nullptr);
  EXPECT_NE(std::string(error_).find("absent.h5"), std::string::npos);
  EXPECT_EQ(palpate_open(nullptr, nullptr, nullptr, 0), nullptr);
  palpate_options wanted = options();
  wanted.tool_name = "spoon";
  EXPECT_EQ(open(wanted), nullptr);
  EXPECT_NE(std::string(error_).find("spoon"), std::string::npos);
  wanted = options();
  wanted.slow_hz = kNan;
  EXPECT_EQ(open(wanted), nullptr);
  wanted = options();
  wanted.flags |= 64;
  EXPECT_EQ(open(wanted), nullptr);
  char small[4];
  EXPECT_EQ(palpate_open("absent.h5", nullptr, small, sizeof small), nullptr);
  EXPECT_EQ(std::strlen(small), 3U);
}

TEST_F(PalpateContract, SixteenToolsAndNoMore) {
  ASSERT_NE(open(options()), nullptr);
  for (int i = 1; i < 16; ++i) {
    EXPECT_NE(palpate_tool_add(body_), nullptr);
  }
  EXPECT_EQ(palpate_tool_add(body_), nullptr);
  EXPECT_EQ(palpate_tool_add(nullptr), nullptr);
  EXPECT_EQ(palpate_tool_open(body_, error_, sizeof error_), nullptr);
  EXPECT_NE(std::string(error_).find("16 tools at most"), std::string::npos) << error_;
  EXPECT_EQ(palpate_tool_open(nullptr, error_, sizeof error_), nullptr);
  EXPECT_NE(std::string(error_).find("no body"), std::string::npos) << error_;
}

TEST_F(PalpateContract, StatusNamesAreFixed) {
  EXPECT_STREQ(palpate_fault_name(PALPATE_FREE), "free");
  EXPECT_STREQ(palpate_fault_name(PALPATE_FAULT_ENERGY), "energy");
  EXPECT_STREQ(palpate_fault_name(PALPATE_ERROR_FORMAT), "format-error");
  EXPECT_STREQ(palpate_fault_name(-99), "unknown");
  EXPECT_STREQ(palpate_fault_name(std::numeric_limits<int>::min()), "unknown");
}

}  // namespace
}  // namespace palpate
