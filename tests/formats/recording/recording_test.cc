#include "formats/recording/recording.h"

#include <chrono>
#include <fstream>
#include <random>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "formats/recording/recording_writer.h"
#include "tests/support/quiet_exit.h"
#include "tests/support/small_database.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

RecordingHeader header() {
  return {.writer = "palpate-run 0.1.0",
          .database = "organ.h5",
          .database_sha256 = std::string(64, 'a'),
          .tool = "ball",
          .model = "element",
          .clock = "real",
          .device = "simulated",
          .fast_hz = 2000.0,
          .slow_hz = 100.0,
          .force_scale = 0.5,
          .ramp_s = 0.1};
}

TickRecord tick(std::int64_t i) {
  const double x = 1e-3 * static_cast<double>(i);
  return {.tick = i,
          .time_ns = 500'000 * i,
          .arrivals = i / 2,
          .position_m = {x, -x, 0.1},
          .force_n = {0.0, x / 3.0, -x},
          .depth_m = x / 7.0,
          .work_j = x / 11.0,
          .stored_j = x / 13.0,
          .tank_j = x / 17.0,
          .dissipated_j = x / 19.0,
          .rest_offset_m = x / 23.0,
          .triangle = static_cast<std::int32_t>(i % 100),
          .flags = static_cast<std::uint8_t>(i % 32),
          .raised = static_cast<std::uint8_t>(i % 3),
          .fault = static_cast<std::uint8_t>(i % 5)};
}

std::vector<TickRecord> ticks(std::int64_t count) {
  std::vector<TickRecord> all;
  for (std::int64_t i = 0; i < count; ++i) {
    all.push_back(tick(i));
  }
  return all;
}

std::vector<ArrivalRecord> arrivals(std::int64_t count) {
  std::vector<ArrivalRecord> all;
  for (std::int64_t i = 0; i < count; ++i) {
    all.push_back({.tick = i / 13,
                   .sequence = i + 1,
                   .sent_ns = 7 * i,
                   .triangle = static_cast<std::int32_t>(i % 50),
                   .active = static_cast<std::uint8_t>(i % 2)});
  }
  return all;
}

void expect_equal(const TickRecord& a, const TickRecord& b) {
  EXPECT_EQ(a.tick, b.tick);
  EXPECT_EQ(a.time_ns, b.time_ns);
  EXPECT_EQ(a.arrivals, b.arrivals);
  EXPECT_EQ(a.position_m, b.position_m);
  EXPECT_EQ(a.force_n, b.force_n);
  EXPECT_EQ(a.depth_m, b.depth_m);
  EXPECT_EQ(a.work_j, b.work_j);
  EXPECT_EQ(a.stored_j, b.stored_j);
  EXPECT_EQ(a.tank_j, b.tank_j);
  EXPECT_EQ(a.dissipated_j, b.dissipated_j);
  EXPECT_EQ(a.rest_offset_m, b.rest_offset_m);
  EXPECT_EQ(a.triangle, b.triangle);
  EXPECT_EQ(a.flags, b.flags);
  EXPECT_EQ(a.raised, b.raised);
  EXPECT_EQ(a.fault, b.fault);
}

class RecordingFile : public testing::Test {
 protected:
  // Two and a half blocks, in pieces.
  fs::path written() {
    const fs::path file = scratch_ / "r.h5";
    RecordingWriter writer(file, header());
    const auto all = ticks(2500);
    writer.append(std::span(all).first(700));
    writer.append(arrivals(1500));
    writer.append(std::span(all).subspan(700));
    writer.finish({.ticks_dropped = 3, .arrivals_dropped = 4, .fault = "energy"});
    return file;
  }

  std::string refusal(const fs::path& file) {
    try {
      (void)read_recording(file);
    } catch (const FormatError& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
      return error.what();
    }
    return "";
  }

  fs::path with_bytes(const std::string& content) {
    const fs::path file = scratch_ / "damaged.h5";
    std::ofstream(file, std::ios::binary) << content;
    return file;
  }

  ScratchFolder scratch_;
};

TEST_F(RecordingFile, GivesBackWhatWasWritten) {
  const fs::path file = written();
  EXPECT_FALSE(fs::exists(file.string() + ".partial"));
  const Recording recording = read_recording(file);
  EXPECT_TRUE(recording.ended);
  EXPECT_EQ(recording.end.ticks_dropped, 3);
  EXPECT_EQ(recording.end.arrivals_dropped, 4);
  EXPECT_EQ(recording.end.fault, "energy");
  EXPECT_EQ(recording.header.tool, "ball");
  EXPECT_EQ(recording.header.database_sha256, std::string(64, 'a'));
  EXPECT_EQ(recording.header.force_scale, 0.5);
  EXPECT_EQ(recording.header.ramp_s, 0.1);
  ASSERT_EQ(recording.tick.size(), 2500U);
  for (std::int64_t i = 0; i < 2500; ++i) {
    expect_equal(recording.tick[static_cast<std::size_t>(i)], tick(i));
  }
  ASSERT_EQ(recording.arrival.size(), 1500U);
  EXPECT_EQ(recording.arrival[1499].sequence, 1500);
  EXPECT_EQ(recording.arrival[1499].triangle, 49);
  EXPECT_EQ(recording.arrival[1499].active, 1);
}

TEST_F(RecordingFile, HoldsItsWholeBlocksAfterTheWriterIsGone) {
  const fs::path file = scratch_ / "r.h5";
  {
    RecordingWriter writer(file, header());
    writer.append(ticks(2500));
    writer.append(arrivals(1100));
    // Read while the writer lives, as after its death: nothing is in its hands only.
    const fs::path copy = scratch_ / "copy.h5";
    fs::copy_file(file.string() + ".partial", copy);
    const Recording recording = read_recording(copy);
    EXPECT_FALSE(recording.ended);
    EXPECT_EQ(recording.arrival.size(), kRecordingBlock);
    ASSERT_EQ(recording.tick.size(), 2 * kRecordingBlock);
    expect_equal(recording.tick.back(), tick(2 * kRecordingBlock - 1));
  }
  {
    RecordingWriter writer(file, header());
    writer.append(ticks(2500));
    const fs::path copy = scratch_ / "other.h5";
    fs::copy_file(file.string() + ".partial", copy);
    EXPECT_EQ(read_recording(copy).tick.size(), 2U);  // the third lacks its element
  }
  {
    // A hand at rest: its few elements do not fill a block, and are there all the same.
    RecordingWriter writer(file, header());
    const auto few = arrivals(900);
    auto all = ticks(2500);
    for (TickRecord& one : all) {
      one.arrivals = std::min(one.arrivals, std::int64_t{900});
    }
    writer.append(std::span(few).first(500));
    writer.append(std::span(all).first(1200));
    writer.append(std::span(few).subspan(500));
    writer.append(std::span(all).subspan(1200));
    const fs::path copy = scratch_ / "rest.h5";
    fs::copy_file(file.string() + ".partial", copy);
    const Recording recording = read_recording(copy);
    EXPECT_EQ(recording.arrival.size(), 900U);
    EXPECT_EQ(recording.arrival.back().sequence, 900);
    EXPECT_EQ(recording.tick.size(), 2 * kRecordingBlock);
  }
  EXPECT_FALSE(fs::exists(file));
  EXPECT_TRUE(fs::exists(file.string() + ".partial"));
}

TEST_F(RecordingFile, CanBeEmpty) {
  const fs::path file = scratch_ / "r.h5";
  RecordingWriter(file, header()).finish({});
  EXPECT_TRUE(read_recording(file).tick.empty());
}

TEST_F(RecordingFile, IsRefusedWhenItIsCutAnywhere) {
  const std::string whole = bytes_of(written());
  for (const double part : {0.0, 0.001, 0.1, 0.5, 0.9, 0.999}) {
    const auto size =
        static_cast<std::size_t>(part * static_cast<double>(whole.size()));
    EXPECT_NE(refusal(with_bytes(whole.substr(0, size))), "") << part;
  }
}

// HDF5 would read the superblock of what another process writes again and again, with
// growing sleeps: a minute and more.
TEST_F(RecordingFile, ADamagedSuperblockIsRefusedAtOnce) {
  const std::string whole = bytes_of(written());
  for (const std::size_t at : {9U, 20U, 30U, 40U, 44U}) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    const fs::path file = with_bytes(damaged);
    const auto begin = std::chrono::steady_clock::now();
    (void)refusal(file);
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(20)) << at;
  }
}

TEST_F(RecordingFile, IsRefusedOrTheSameWithAFlippedBit) {
  const std::string whole = bytes_of(written());
  const Recording sound = read_recording(written());
  std::mt19937 generator(7);
  std::uniform_int_distribution<std::size_t> place(0, whole.size() - 1);
  int refused = 0;
  constexpr int kFlips = 300;
  for (int i = 0; i < kFlips; ++i) {
    std::string damaged = whole;
    damaged[place(generator)] ^= static_cast<char>(1 << (i % 8));
    const fs::path file = with_bytes(damaged);
    try {
      const Recording recording = read_recording(file);
      ASSERT_EQ(recording.tick.size(), sound.tick.size());
      for (std::size_t k = 0; k < sound.tick.size(); k += 50) {
        expect_equal(recording.tick[k], sound.tick[k]);
      }
    } catch (const FormatError&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, kFlips / 2);  // the rest hit space that nothing uses
}

TEST_F(RecordingFile, IsNotADatabaseAndADatabaseIsNotARecording) {
  const fs::path database = scratch_ / "d.h5";
  write_database(database, small_database());
  EXPECT_NE(refusal(database).find("is not a recording"), std::string::npos)
      << refusal(database);
  EXPECT_EQ(database_sha256(database).size(), 64U);
  EXPECT_NE(refusal(with_bytes("text")).find("is not an HDF5 file"), std::string::npos);
  EXPECT_THROW((void)read_recording(scratch_ / "none.h5"), InputError);
}

TEST_F(RecordingFile, IsRefusedIfAForceIsNotFiniteOrTicksGoBack) {
  const auto write = [&](const TickRecord& second) {
    const fs::path file = scratch_ / "r.h5";
    RecordingWriter writer(file, header());
    writer.append(std::array{tick(5), second});
    writer.finish({});
    return file;
  };
  TickRecord wrong = tick(6);
  wrong.force_n[1] = std::nan("");
  EXPECT_NE(refusal(write(wrong)).find("tick 6 has a force"), std::string::npos);
  EXPECT_NE(refusal(write(tick(4))).find("tick number 4 in row 1"), std::string::npos);
  wrong = tick(6);
  wrong.position_m[0] = std::nan("");  // what a device said
  EXPECT_EQ(refusal(write(wrong)), "");
}

TEST_F(RecordingFile, ThatCannotBeWrittenIsSaidAtOnce) {
  EXPECT_THROW(RecordingWriter(scratch_ / "no/folder.h5", header()), InputError);
  EXPECT_THROW(RecordingWriter(scratch_.path(), header()), InputError);
}

}  // namespace
}  // namespace palpate
