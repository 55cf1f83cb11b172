#include "formats/recording/contact_recording.h"

#include <cstdint>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/old_contact_recording.h"
#include "tests/support/quiet_exit.h"
#include "tests/support/said.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

OldContactRecording two_hands() {
  OldContactRecording r;
  r.writer = "palpate-run 0.1.0";
  r.database = "organ.h5";
  r.database_sha256 = std::string(64, 'a');
  r.tools = {"thumb", "finger"};
  r.fast_hz = 2000.0;
  r.slow_hz = 100.0;
  r.force_scale = 1.0 / 3.0;
  r.force_max_n = 8.0;
  r.fault = "energy";
  r.time_s = {0.0, 0.0005, 0.0011};
  r.pose = RowMajor<double>::Zero(3, 14);
  r.pose.col(6).setOnes();
  r.pose.col(13).setOnes();
  r.pose(1, 7) = 1.0 / 7.0;
  r.wrench = RowMajor<double>::Random(3, 12);
  r.contacts = {0, 2, 1};
  for (auto* column :
       {&r.depth_m, &r.work_j, &r.stored_j, &r.tank_j, &r.dissipated_j}) {
    *column = {0.1, 1.0 / 3.0, -1e-3};
  }
  return r;
}

TEST(ContactRecordingFile, ReadsWhatWasWritten) {
  const ScratchFolder folder;
  const OldContactRecording r = two_hands();
  write_old_contact_recording(folder / "r.h5", r);
  EXPECT_TRUE(is_contact_recording(folder / "r.h5"));
  // As any recording.
  const Recording read = read_recording(folder / "r.h5");
  EXPECT_EQ(read.header.writer, r.writer);
  EXPECT_EQ(read.header.database, r.database);
  EXPECT_EQ(read.header.database_sha256, r.database_sha256);
  EXPECT_EQ(read.header.tool, "thumb");
  EXPECT_EQ(read.header.second_tool, "finger");
  EXPECT_EQ(read.hands(), 2U);
  EXPECT_EQ(read.header.force_scale, r.force_scale);
  EXPECT_EQ(read.end.fault, r.fault);
  ASSERT_TRUE(read.old);
  EXPECT_EQ(read.old->time_s, r.time_s);
  EXPECT_EQ(read.old->answer_ticks, 20);
  ASSERT_EQ(read.tick.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    const TickRecord& tick = read.tick[i];
    const auto row = static_cast<Eigen::Index>(i);
    EXPECT_EQ(tick.position_m[1], r.pose(row, 1));
    EXPECT_EQ(tick.turn[3], r.pose(row, 6));
    EXPECT_EQ(tick.second.position_m[0], r.pose(row, 7));
    EXPECT_EQ(tick.force_n[2], r.wrench(row, 2));
    EXPECT_EQ(tick.second.torque_n_m[2], r.wrench(row, 11));
    EXPECT_EQ(tick.contacts, r.contacts[i]);
    EXPECT_EQ(tick.depth_m, r.depth_m[i]);
    EXPECT_EQ(tick.work_j, r.work_j[i]);
    EXPECT_EQ(tick.stored_j, r.stored_j[i]);
    EXPECT_EQ(tick.tank_j, r.tank_j[i]);
    EXPECT_EQ(tick.dissipated_j, r.dissipated_j[i]);
  }
}

TEST(ContactRecordingFile, WhatBreaksItsRulesIsRefusedByPlace) {
  const ScratchFolder folder;
  const auto said = [&](auto&& change) {
    OldContactRecording r = two_hands();
    change(r);
    write_old_contact_recording(folder / "r.h5", r);
    return refusal([&] {
      (void)read_contact_recording(folder / "r.h5");
    });
  };
  const auto expect = [](const std::string& text, const char* part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  EXPECT_EQ(said([](OldContactRecording& /*r*/) {}), "");
  expect(said([](OldContactRecording& r) {
           r.time_s[2] = r.time_s[1];
         }),
         "/tick/time_s, row 2: 0.0005, must rise");
  expect(said([](OldContactRecording& r) {
           r.pose(1, 13) = 0.9;
         }),
         "/tick/pose, row 1: hand 2");
  expect(said([](OldContactRecording& r) {
           r.pose(2, 0) = std::numeric_limits<double>::quiet_NaN();
         }),
         "/tick/pose, row 2: hand 1");
  expect(said([](OldContactRecording& r) {
           r.tools = {"thumb"};
         }),
         "/tick/pose has 3 rows of 14, must have 3 of 7");
  expect(said([](OldContactRecording& r) {
           r.tools = {"a", "b", "c"};
         }),
         "names 3 tools");
  expect(said([](OldContactRecording& r) {
           r.tank_j.pop_back();
         }),
         "/tick/tank_j has 2 rows");
  expect(said([](OldContactRecording& r) {
           r.force_scale = 0.0;
         }),
         "force_scale");
}

TEST(ContactRecordingFile, ForeignAndDamagedFilesAreRefused) {
  const ScratchFolder folder;
  std::ofstream(folder / "text") << "no HDF5";
  EXPECT_FALSE(is_contact_recording(folder / "text"));
  EXPECT_FALSE(is_contact_recording(folder / "missing.h5"));
  EXPECT_NE(refusal([&] {
              (void)read_contact_recording(folder / "missing.h5");
            }),
            "");
  write_old_contact_recording(folder / "r.h5", two_hands());
  std::string bytes = bytes_of(folder / "r.h5");
  // One bit of a stored number.
  const double number = 1.0 / 7.0;
  const std::string raw(reinterpret_cast<const char*>(&number), sizeof number);
  const std::size_t at = bytes.find(raw);
  ASSERT_NE(at, std::string::npos);
  bytes[at] = static_cast<char>(bytes[at] ^ 1);
  std::ofstream(folder / "r.h5", std::ios::binary) << bytes;
  EXPECT_NE(refusal([&] {
              (void)read_contact_recording(folder / "r.h5");
            }).find("damaged"),
            std::string::npos);
}

}  // namespace
}  // namespace palpate
