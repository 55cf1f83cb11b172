#include "formats/service/service_message.h"

#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "tests/support/sample_units.h"

namespace palpate {
namespace {

std::vector<std::byte> body_of(const std::vector<std::byte>& frame) {
  FrameReader reader;
  reader.take(frame);
  return reader.next();
}

ServedScene sample_scene() {
  return {.plan = sample_plan(),
          .reachable = {0, 1, 2, 3, 4},
          .output = "/tmp/organ.h5",
          .nonlinear = true,
          .modulus_pa = 7500.0};
}

ServedResponses sample_responses() {
  return {.quality = AnswerQuality::kFinal, .node = sample_units().front().node};
}

template <typename T>
T through_the_wire(const T& message) {
  return std::get<T>(message_from_bytes(body_of(to_frame(message))));
}

TEST(ServiceMessage, SceneComesThroughWhole) {
  const ServedScene sent = sample_scene();
  const ServedScene got = through_the_wire(sent);
  EXPECT_EQ(to_bytes(got.plan), to_bytes(sent.plan));
  EXPECT_EQ(got.reachable, sent.reachable);
  EXPECT_EQ(got.output, sent.output);
  EXPECT_EQ(got.nonlinear, sent.nonlinear);
  EXPECT_EQ(got.modulus_pa, sent.modulus_pa);
}

TEST(ServiceMessage, AModulusThatIsNoneIsRefused) {
  ServedScene scene = sample_scene();
  for (const double modulus_pa : {-1.0, std::numeric_limits<double>::infinity()}) {
    scene.modulus_pa = modulus_pa;
    EXPECT_THROW(through_the_wire(scene), FormatError);
  }
}

// As a database with them would be.
TEST(ServiceMessage, APlanThatNoDatabaseMayHaveIsRefused) {
  const auto refused = [](auto spoil) {
    ServedScene scene = sample_scene();
    spoil(scene.plan);
    EXPECT_THROW(through_the_wire(scene), FormatError);
  };
  refused([](JobDescription& plan) {
    plan.normal.row(0) *= 20.0;
  });
  refused([](JobDescription& plan) {
    plan.tool[0].friction = 1e6;
  });
  refused([](JobDescription& plan) {
    plan.body.triangle(0, 1) = plan.body.triangle(0, 0);
  });
  refused([](JobDescription& plan) {
    plan.depth_max_m = std::numeric_limits<double>::infinity();
  });
  refused([](JobDescription& plan) {
    plan.force_relative = -0.1;
  });
}

// A byte each, and sixteen in memory.
TEST(ServiceMessage, MoreValuesThanTheMemoryHoldsAreRefused) {
  constexpr std::uint32_t kMany = (std::uint32_t{1} << 27) + 1;
  std::vector<std::byte> body(kMany + 5, std::byte{0x00});
  body[0] = std::byte{0x9a};  // a list of so many
  for (std::size_t i = 0; i < 4; ++i) {
    body[1 + i] = static_cast<std::byte>(kMany >> (24 - 8 * i));
  }
  try {
    (void)message_from_bytes(body);
    FAIL() << "read";
  } catch (const FormatError& error) {
    EXPECT_NE(std::string(error.what()).find("values"), std::string::npos);
  }
}

TEST(ServiceMessage, ResponsesComeThroughWhole) {
  const ServedResponses sent = sample_responses();
  const ServedResponses got = through_the_wire(sent);
  EXPECT_EQ(got.quality, AnswerQuality::kFinal);
  EXPECT_EQ(to_bytes(WorkUnitOutcome{.index = 1, .node = got.node}),
            to_bytes(WorkUnitOutcome{.index = 1, .node = sent.node}));
}

TEST(ServiceMessage, OthersComeThroughWhole) {
  const auto progress = through_the_wire(ServedProgress{
      .stage = "preliminary answers", .nodes = 9, .answered = 5, .finished = 2});
  EXPECT_EQ(progress.stage, "preliminary answers");
  EXPECT_EQ(progress.nodes, 9);
  EXPECT_EQ(progress.answered, 5);
  EXPECT_EQ(progress.finished, 2);
  const auto end = through_the_wire(ServedEnd{.file = "a.h5", .failure = "b"});
  EXPECT_EQ(end.file, "a.h5");
  EXPECT_EQ(end.failure, "b");
  const auto hand = through_the_wire(HandPlace{.tool = 1,
                                               .position_m = {1.0, 2.0, 3.0},
                                               .velocity_m_per_s = {-1.0, 0.5, 0.0},
                                               .touches = true});
  EXPECT_EQ(hand.tool, 1);
  EXPECT_EQ(hand.position_m, Eigen::Vector3d(1.0, 2.0, 3.0));
  EXPECT_EQ(hand.velocity_m_per_s, Eigen::Vector3d(-1.0, 0.5, 0.0));
  EXPECT_TRUE(hand.touches);
}

TEST(ServiceMessage, FramesComeInAnyPieces) {
  std::vector<std::byte> bytes;
  for (int i = 0; i < 3; ++i) {
    const auto frame = to_frame(ServedProgress{.stage = "s", .nodes = i});
    bytes.insert(bytes.end(), frame.begin(), frame.end());
  }
  for (const std::size_t piece : {1UL, 2UL, 7UL, 1000UL}) {
    FrameReader reader;
    std::int64_t next = 0;
    for (std::size_t at = 0; at < bytes.size(); at += piece) {
      reader.take(std::span(bytes).subspan(at, std::min(piece, bytes.size() - at)));
      for (auto body = reader.next(); !body.empty(); body = reader.next()) {
        EXPECT_EQ(std::get<ServedProgress>(message_from_bytes(body)).nodes, next++);
      }
    }
    EXPECT_EQ(next, 3) << piece;
  }
}

TEST(ServiceMessage, WhatIsNoFrameIsRefused) {
  FrameReader foreign;
  const std::vector<std::byte> http(4, std::byte{'G'});
  EXPECT_THROW(foreign.take(http), FormatError);
  FrameReader longer;
  std::vector<std::byte> head = to_frame(ServedEnd{});
  head.resize(8);
  head[7] = std::byte{0x41};  // more than 2^30 bytes
  EXPECT_THROW(longer.take(head), FormatError);
}

TEST(ServiceMessage, WhatBreaksARuleIsRefused) {
  const auto refused = [](const ServiceMessage& message) {
    EXPECT_THROW((void)message_from_bytes(body_of(to_frame(message))), FormatError);
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  refused(HandPlace{.position_m = {0.0, nan, 0.0}});
  refused(HandPlace{.tool = -1});
  ServedScene scene = sample_scene();
  scene.reachable = {0, 0};
  refused(scene);
  scene.reachable = {0, 6};
  refused(scene);
  scene = sample_scene();
  scene.plan.body.triangle(0, 0) = 6;
  refused(scene);
  scene = sample_scene();
  scene.plan.normal.conservativeResize(5, 3);
  refused(scene);
  ServedResponses responses = sample_responses();
  responses.node.front().response.force_n.back() = nan;
  refused(responses);
  responses = sample_responses();
  responses.node.front().vertex = -1;
  refused(responses);
}

TEST(ServiceMessage, DeepNestingIsRefusedInsteadOfEndingTheStack) {
  const std::vector<std::byte> nested(1 << 20, std::byte{0x81});  // arrays of one
  EXPECT_THROW((void)message_from_bytes(nested), FormatError);
}

TEST(ServiceMessage, DamagedBytesAreRefusedOrRead) {
  const std::vector<std::byte> body = body_of(to_frame(sample_responses()));
  std::mt19937 random(7);
  int refused = 0;
  for (int i = 0; i < 2000; ++i) {
    std::vector<std::byte> damaged = body;
    damaged[random() % damaged.size()] = static_cast<std::byte>(random());
    damaged.resize(i % 3 == 0 ? random() % damaged.size() : damaged.size());
    try {
      (void)message_from_bytes(damaged);
    } catch (const FormatError&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 600);  // all that were cut short, at least
}

}  // namespace
}  // namespace palpate
