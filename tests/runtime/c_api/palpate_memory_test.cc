// A database whose bytes are in memory, as hosts open it.
#include "runtime/c_api/palpate_memory.h"

#include <cstring>
#include <vector>

#include "tests/runtime/c_api/pressed_plate_host.h"

namespace palpate {
namespace {

class PalpateMemory : public PressedPlateHost {
 protected:
  void SetUp() override {
    PressedPlateHost::SetUp();
    write_database(flat_, read_database(file_));
  }

  palpate_tool* open_bytes(const std::string& bytes, const palpate_options& options) {
    palpate_close(body_);
    body_ = palpate_open_memory(bytes.data(), bytes.size(), &options, error_,
                                sizeof error_);
    return body_ == nullptr ? nullptr : palpate_tool_add(body_);
  }

  // Force and status of every tick of a press.
  std::vector<double> pressed(palpate_tool* tool) {
    std::vector<double> all;
    for (int tick = 0; tick < 900; ++tick) {
      const double part = std::min(1.0, tick / 400.0);
      const Answer answer = force(tool, -0.001 + part * 0.004);
      all.insert(all.end(), answer.force.begin(), answer.force.end());
      all.push_back(answer.status);
      if (tick % 10 == 0) {
        EXPECT_GE(palpate_slow_step(body_), 0);
      }
    }
    return all;
  }

  const std::filesystem::path flat_ = folder_ / "plate.palpate";
};

TEST_F(PalpateMemory, EveryFormGivesTheSameForcesToTheBit) {
  const std::vector<double> expected = pressed(open(options()));
  EXPECT_GT(expected[expected.size() - 2], 0.1);
  for (const std::filesystem::path& file : {std::filesystem::path(file_), flat_}) {
    std::string bytes = bytes_of(file);
    palpate_tool* tool = open_bytes(bytes, options());
    ASSERT_NE(tool, nullptr) << error_;
    bytes.assign(bytes.size(), 'x');  // it is the host's again
    EXPECT_EQ(pressed(tool), expected) << file;
  }
  file_ = flat_.string();
  EXPECT_EQ(pressed(open(options())), expected);
}

TEST_F(PalpateMemory, StreamedItIsReadWhereItLies) {
  palpate_options streamed = options();
  streamed.flags |= PALPATE_STREAMED;
  const std::vector<double> expected = pressed(open(streamed));
  const std::string bytes = bytes_of(flat_);
  palpate_tool* tool = open_bytes(bytes, streamed);
  ASSERT_NE(tool, nullptr) << error_;
  EXPECT_EQ(pressed(tool), expected);
}

TEST_F(PalpateMemory, ASurfaceOfItIsTheDatabases) {
  const std::string bytes = bytes_of(flat_);
  palpate_tool* tool = open_bytes(bytes, options());
  ASSERT_NE(tool, nullptr) << error_;
  const std::string surface = (folder_ / "surface.palpate").string();
  ASSERT_EQ(palpate_surface_save(tool, surface.c_str(), error_, sizeof error_), 0)
      << error_;
  EXPECT_EQ(
      palpate_surface_load(open(options()), surface.c_str(), error_, sizeof error_), 0)
      << error_;
}

TEST_F(PalpateMemory, WhatIsNoDatabaseIsRefusedInOneLine) {
  const std::string bytes = bytes_of(flat_);
  const auto refusal_of = [&](const std::string& given, std::uint32_t flags) {
    palpate_options all = options();
    all.flags |= flags;
    EXPECT_EQ(open_bytes(given, all), nullptr);
    return std::string(error_);
  };
  EXPECT_EQ(refusal_of("solid cube", 0),
            "bytes in memory: is not an HDF5 file (10 bytes), nor a flat one, must be "
            "a response database");
  EXPECT_NE(refusal_of(bytes.substr(0, bytes.size() - 1), 0).find("truncated"),
            std::string::npos);
  EXPECT_NE(refusal_of(bytes, PALPATE_SCENE).find("by the name of its file"),
            std::string::npos);
  EXPECT_EQ(palpate_open_memory(nullptr, 8, nullptr, error_, sizeof error_), nullptr);
  EXPECT_STREQ(error_, "no bytes are given: the pointer is null");
  EXPECT_EQ(palpate_open_memory("", 0, nullptr, nullptr, 0), nullptr);
}

}  // namespace
}  // namespace palpate
