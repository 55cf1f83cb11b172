#include "runtime/render/recorder.h"

#include <csignal>

#include <gtest/gtest.h>
#include <sys/resource.h>

#include "formats/base/error.h"
#include "tests/support/quiet_exit.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

RecordingHeader header() {
  return {.fast_hz = 2000.0, .slow_hz = 100.0};
}

class RecorderFile : public testing::Test {
 protected:
  ScratchFolder scratch_;
  fs::path file_ = scratch_ / "r.h5";
};

TEST_F(RecorderFile, CountsWhatAFullQueueDropsAndSaysSoInTheFile) {
  Recorder recorder(file_, header());
  for (std::int64_t i = 0; i < 10'000; ++i) {  // nobody empties the queue of 8192
    (void)recorder.telemetry().ticks.push({.tick = i});
  }
  recorder.drain();
  (void)recorder.telemetry().ticks.push({.tick = 10'000});
  recorder.finish("deadlines");
  EXPECT_EQ(recorder.dropped(), 1808U);
  const Recording recording = read_recording(file_);
  EXPECT_EQ(recording.end.ticks_dropped, 1808);
  EXPECT_EQ(recording.end.fault, "deadlines");
  ASSERT_EQ(recording.tick.size(), 8193U);
  EXPECT_EQ(recording.tick[8191].tick, 8191);
  EXPECT_EQ(recording.tick[8192].tick, 10'000);  // the gap shows
}

TEST_F(RecorderFile, WritesEverythingThatItsThreadCouldTake) {
  Recorder recorder(file_, header());
  recorder.start();
  std::int64_t pushed = 0;
  for (std::int64_t i = 0; i < 50'000; ++i) {
    pushed += recorder.telemetry().ticks.push({.tick = i}) ? 1 : 0;
  }
  recorder.finish("none");
  const Recording recording = read_recording(file_);
  EXPECT_EQ(static_cast<std::int64_t>(recording.tick.size()), pushed);
  EXPECT_EQ(recording.end.ticks_dropped, 50'000 - pushed);
}

TEST_F(RecorderFile, EndsTheRecordingWhenAnExceptionPassesBy) {
  try {
    Recorder recorder(file_, header());
    recorder.start();
    (void)recorder.telemetry().ticks.push({.tick = 0});
    throw InputError("on the way out");
  } catch (const InputError&) {
  }
  const Recording recording = read_recording(file_);
  EXPECT_EQ(recording.tick.size(), 1U);
  EXPECT_EQ(recording.end.fault, "exception");
}

TEST_F(RecorderFile, OfAFullDiskEndsAndTheRunGoesOn) {
  Recorder recorder(file_, header());
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  rlimit small = before;
  small.rlim_cur = 200'000;
  setrlimit(RLIMIT_FSIZE, &small);
  for (std::int64_t i = 0; i < 8192; ++i) {
    (void)recorder.telemetry().ticks.push({.tick = i});
  }
  recorder.drain();
  (void)recorder.telemetry().ticks.push({.tick = 8192});  // goes nowhere, harms nobody
  recorder.drain();
  recorder.finish("none");
  setrlimit(RLIMIT_FSIZE, &before);
  EXPECT_NE(recorder.failure().find("r.h5: cannot be written"), std::string::npos)
      << recorder.failure();
  EXPECT_FALSE(fs::exists(file_));
  EXPECT_TRUE(fs::exists(file_.string() + ".partial"));
}

TEST_F(RecorderFile, OfTheFlightBeginsWhereTheLogDoes) {
  FlightLog log;
  constexpr std::int64_t kAll = 20'000;
  for (std::int64_t i = 0; i < kAll; ++i) {
    log.ticks.add({.tick = i});
    log.arrivals.add({.tick = i});
  }
  write_flight_log(file_, header(), log, "device-lost");
  const Recording recording = read_recording(file_);
  ASSERT_EQ(recording.tick.size(), FlightLog::kTicks);
  EXPECT_EQ(recording.tick.back().tick, kAll - 1);
  EXPECT_EQ(recording.arrival.size(), FlightLog::kTicks);
  EXPECT_EQ(recording.end.fault, "device-lost");
}

TEST(LatestLog, KeepsTheLatestInTheirOrder) {
  LatestLog<int> log(4);
  EXPECT_TRUE(log.values().empty());
  log.add(1);
  log.add(2);
  EXPECT_EQ(log.values(), (std::vector<int>{1, 2}));
  for (int i = 3; i <= 10; ++i) {
    log.add(i);
  }
  EXPECT_EQ(log.values(), (std::vector<int>{7, 8, 9, 10}));
}

}  // namespace
}  // namespace palpate
