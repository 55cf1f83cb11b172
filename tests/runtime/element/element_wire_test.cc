#include "runtime/element/element_wire.h"

#include <cstring>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "runtime/bench/bench_body.h"
#include "runtime/fast/fast_step.h"
#include "tests/support/allocation_guard.h"

namespace palpate {
namespace {

constexpr std::uint32_t kSession = 77;
constexpr NodeYielding kYielding{.yield_depth_m = 0.001,
                                 .share = 0.4,
                                 .onset_m = 0.002,
                                 .scale_m = 0.003,
                                 .largest = 0.5};

Element element(std::uint64_t sequence) {
  static const BenchBody body = make_bench_body({.contrast = 9.0,
                                                 .tilt_rad = 0.2,
                                                 .tilt_by_height_per_m = 20.0,
                                                 .friction_max = 1.0,
                                                 .lateral = 2.0,
                                                 .touch_offset_m = 3e-4,
                                                 .relaxing = {0.25, 0.3},
                                                 .relaxation_s = {0.4, 4.5},
                                                 .bundles = 8,
                                                 .yielding = kYielding,
                                                 .cells_per_site = 2});
  Element made = body.element[sequence % body.element.size()];
  made.sequence = sequence;
  made.sent_ns = 1000 * static_cast<std::int64_t>(sequence);
  made.active = sequence % 3 == 0;
  for (std::size_t j = 0; j < 3; ++j) {
    made.puncture[j] = {.layers = 2,
                        .rupture = 1.5 + static_cast<double>(j),
                        .depth_m = {0.0, 0.002},
                        .material = {3, 1}};
  }
  return made;
}

using Bytes = std::vector<std::byte>;

void add(Bytes& wire, const Element& sent, std::uint32_t session = kSession) {
  WireFrame frame;
  encode(sent, session, frame);
  wire.insert(wire.end(), frame.begin(), frame.end());
}

// The sequence numbers that come out of a wire, in pieces of `piece` bytes.
std::vector<std::uint64_t> receive_all(ElementReceiver& receiver, const Bytes& wire,
                                       std::size_t piece) {
  std::vector<std::uint64_t> got;
  Element out;
  for (std::size_t at = 0; at < wire.size(); at += piece) {
    std::span<const std::byte> bytes =
        std::span(wire).subspan(at, std::min(piece, wire.size() - at));
    while (!bytes.empty()) {
      if (receive(receiver, bytes, out)) {
        const Element sent = element(out.sequence);
        EXPECT_EQ(out.triangle, sent.triangle);
        EXPECT_EQ(out.active, sent.active);
        EXPECT_EQ(out.sent_ns, sent.sent_ns);
        EXPECT_EQ(out.touch_height_m, sent.touch_height_m);
        EXPECT_EQ(out.neighbour, sent.neighbour);
        for (std::size_t j = 0; j < 3; ++j) {
          EXPECT_EQ(out.node[j].direction, sent.node[j].direction);
          EXPECT_EQ(out.node[j].tilt, sent.node[j].tilt);
          EXPECT_EQ(out.node[j].tilt_by_height_per_m,
                    sent.node[j].tilt_by_height_per_m);
          EXPECT_EQ(out.node[j].energy_j, sent.node[j].energy_j);
          EXPECT_EQ(out.node[j].friction, sent.node[j].friction);
          EXPECT_EQ(out.memory.node[j].site, sent.memory.node[j].site);
          EXPECT_EQ(out.memory.node[j].weight, sent.memory.node[j].weight);
          EXPECT_EQ(out.memory.node[j].relaxing, sent.memory.node[j].relaxing);
          EXPECT_EQ(out.memory.node[j].cut_m, sent.memory.node[j].cut_m);
          EXPECT_EQ(out.memory.node[j].yield_depth_m, 0.001);
          EXPECT_EQ(out.memory.node[j].dent_share, 0.4);
          EXPECT_EQ(out.memory.node[j].onset_m, 0.002);
          EXPECT_EQ(out.memory.node[j].soft_scale_m, 0.003);
          EXPECT_EQ(out.memory.node[j].soft_most, 0.5);
          EXPECT_EQ(out.puncture[j].layers, 2);
          EXPECT_EQ(out.puncture[j].rupture, sent.puncture[j].rupture);
          EXPECT_EQ(out.puncture[j].depth_m, sent.puncture[j].depth_m);
          EXPECT_EQ(out.puncture[j].material, sent.puncture[j].material);
        }
        EXPECT_TRUE(out.memory.yields);
        EXPECT_EQ(out.memory.terms, 2);
        EXPECT_EQ(out.memory.bundles, 8);
        EXPECT_EQ(out.memory.relaxation_s, sent.memory.relaxation_s);
        got.push_back(out.sequence);
      }
    }
  }
  return got;
}

using Sequences = std::vector<std::uint64_t>;

TEST(ElementWire, ChecksumIsThatOfTheStandard) {
  const char* text = "123456789";
  EXPECT_EQ(crc32(std::as_bytes(std::span(text, 9))), 0xCBF43926U);
}

TEST(ElementWire, FrameHasTheBytesThatItsDescriptionSays) {
  WireFrame frame;
  Element sent = element(3);
  encode(sent, 0x01020304, frame);
  EXPECT_EQ(std::memcmp(frame.data(), "PLPE\x06\x00\x03\x00\x04\x03\x02\x01", 12), 0);
  EXPECT_EQ(std::memcmp(frame.data() + 44, "\x02\x00\x08\x00", 4), 0);
  double number = -1.0;
  std::memcpy(&number, frame.data() + 48 + 8, 8);
  EXPECT_EQ(number, 4.5);
  std::memcpy(&number, frame.data() + 88 + 2026 + 8 + 144 + 2 * 8, 8);
  EXPECT_EQ(number, sent.node[1].lateral[2]);
  std::memcpy(&number, frame.data() + 88 + 2026 + 8 + 240 + 8, 8);
  EXPECT_EQ(number, sent.node[1].depth_m[1]);
  std::memcpy(&number, frame.data() + 88 + 2 * 2026 + 1960 - 6 * 8, 8);
  EXPECT_EQ(number, sent.memory.node[2].cut_m[6]);
  std::memcpy(&number, frame.data() + 88 + 2 * 2026 + 1960 - 8, 8);
  EXPECT_EQ(number, sent.memory.node[2].soft_most);
  std::memcpy(&number, frame.data() + 88 + 2 * 2026 + 1960 + 4 + 2 * 8, 8);
  EXPECT_EQ(number, sent.puncture[2].depth_m[1]);
  EXPECT_EQ(frame[88 + 3 * 2026 - 6], std::byte{3});
}

TEST(ElementWire, PiecesOfAnySizeGiveEveryElement) {
  Bytes wire;
  for (std::uint64_t i = 1; i <= 5; ++i) {
    add(wire, element(i));
  }
  for (const std::size_t piece : {1UL, 7UL, 64UL, 6169UL, 6170UL, 6171UL, 99999UL}) {
    ElementReceiver receiver;
    EXPECT_EQ(receive_all(receiver, wire, piece), (Sequences{1, 2, 3, 4, 5})) << piece;
    EXPECT_EQ(receiver.counts.accepted, 5U);
    EXPECT_EQ(receiver.counts.skipped_bytes, 0U);
    EXPECT_EQ(receiver.counts.lost, 0U);
  }
}

TEST(ElementWire, LostRepeatedAndLateFramesAreCountedAndDropped) {
  Bytes wire;
  for (const std::uint64_t i : {1, 2, 2, 5, 4, 4, 6, 1, 200, 100}) {
    add(wire, element(i));
  }
  ElementReceiver receiver;
  EXPECT_EQ(receive_all(receiver, wire, 512), (Sequences{1, 2, 5, 6, 200}));
  EXPECT_EQ(receiver.counts.lost, 2U + 193U);
  EXPECT_EQ(receiver.counts.repeated, 3U);  // 2, 4, 1
  EXPECT_EQ(receiver.counts.late, 2U);      // 4, 100
}

TEST(ElementWire, RestartedSenderIsHeardAtOnce) {
  Bytes wire;
  add(wire, element(900));
  add(wire, element(1), kSession + 1);
  add(wire, element(2), kSession + 1);
  ElementReceiver receiver;
  EXPECT_EQ(receive_all(receiver, wire, 4096), (Sequences{900, 1, 2}));
  EXPECT_EQ(receiver.counts.sessions, 2U);
}

TEST(ElementWire, EveryFlippedBitOfAFrameIsFoundAndTheNextFrameComes) {
  Bytes clean;
  add(clean, element(1));
  add(clean, element(2));
  for (std::size_t bit = 0; bit < 8 * kWireBytes; bit += 97) {
    Bytes wire = clean;
    wire[bit / 8] ^= static_cast<std::byte>(1U << (bit % 8));
    ElementReceiver receiver;
    EXPECT_EQ(receive_all(receiver, wire, 99999), (Sequences{2})) << bit;
  }
}

TEST(ElementWire, CutAndStrayBytesCostOneFrameAtMost) {
  std::mt19937 random(3);
  for (int round = 0; round < 50; ++round) {
    Bytes wire;
    add(wire, element(1));
    const std::size_t cut = 1 + random() % (kWireBytes - 1);
    Bytes second;
    add(second, element(2));
    wire.insert(wire.end(), second.begin(),
                second.begin() + static_cast<std::ptrdiff_t>(cut));
    for (std::size_t i = random() % 300; i > 0; --i) {
      wire.push_back(static_cast<std::byte>(random()));
    }
    add(wire, element(3));
    add(wire, element(4));
    ElementReceiver receiver;
    EXPECT_EQ(receive_all(receiver, wire, 333), (Sequences{1, 3, 4})) << round;
    EXPECT_EQ(receiver.counts.lost, 1U);
  }
}

TEST(ElementWire, WrongValuesUnderARightChecksumAreRefused) {
  const auto refused = [](auto spoil) {
    Element sent = element(1);
    spoil(sent);
    Bytes wire;
    add(wire, sent);
    add(wire, element(2));
    ElementReceiver receiver;
    return receive_all(receiver, wire, 99999) == Sequences{2} &&
           receiver.counts.broken > 0;
  };
  EXPECT_TRUE(refused([](Element& e) {
    e.triangle = -1;
  }));
  EXPECT_TRUE(refused([](Element& e) {
    e.sequence = 0;
  }));
  EXPECT_TRUE(refused([](Element& e) {
    e.node[2].force_n[1] = std::numeric_limits<double>::quiet_NaN();
  }));
  EXPECT_TRUE(refused([](Element& e) {
    e.node[0].samples = 1;
  }));
  EXPECT_TRUE(refused([](Element& e) {
    e.memory.terms = 5;
  }));
  EXPECT_TRUE(refused([](Element& e) {
    e.memory.bundles = 0;
  }));
  EXPECT_TRUE(refused([](Element& e) {
    e.memory.relaxation_s[0] = 0.0;
  }));
  EXPECT_TRUE(refused([](Element& e) {
    std::swap(e.memory.relaxation_s[0], e.memory.relaxation_s[1]);
  }));
  EXPECT_TRUE(refused([](Element& e) {
    e.memory.relaxation_s[1] = std::numeric_limits<double>::infinity();
  }));
  EXPECT_TRUE(refused([](Element& e) {
    e.memory.node[1].relaxing[0] = 0.75;
  }));
  EXPECT_TRUE(refused([](Element& e) {
    e.memory.node[1].relaxing[0] = std::numeric_limits<double>::quiet_NaN();
  }));
  EXPECT_TRUE(refused([](Element& e) {
    e.memory.node[0].weight[1] = -0.25;
  }));
  EXPECT_TRUE(refused([](Element& e) {
    std::swap(e.memory.node[2].cut_m[0], e.memory.node[2].cut_m[3]);
  }));
  EXPECT_TRUE(refused([](Element& e) {
    e.puncture[1].layers = 7;
  }));
  EXPECT_TRUE(refused([](Element& e) {
    e.puncture[2].depth_m[1] = 0.0;
  }));
  EXPECT_TRUE(refused([](Element& e) {
    e.puncture[0].material[1] = 8;
  }));
}

TEST(ElementWire, NoiseYieldsNothingAndAllocatesNothing) {
  std::mt19937 random(5);
  Bytes noise(100000);
  for (std::byte& byte : noise) {
    byte = static_cast<std::byte>(random());
  }
  ElementReceiver receiver;
  Element out;
  std::span<const std::byte> bytes(noise);
  const test::AllocationGuard guard;
  while (!bytes.empty()) {
    EXPECT_FALSE(receive(receiver, bytes, out));
  }
  EXPECT_EQ(guard.count(), 0U);
  EXPECT_GE(receiver.counts.skipped_bytes + receiver.filled, 100000U);
}

// The fast step behind a wire that breaks a third of the frames: passive, no fault.
TEST(ElementWire, FastStepBehindABadWireStaysPassive) {
  const BenchBody body = make_bench_body({.contrast = 9.0, .friction_max = 1.0});
  FastState state;
  state.config.model = LocalModel::kPotential;
  state.config.tool_radius_m = 0.005;
  ElementReceiver receiver;
  std::mt19937 random(9);
  Element out;
  std::uint64_t sequence = 0;
  int contacts = 0;
  int tick = 0;
  const std::vector<Eigen::Vector3d> path =
      make_bench_walk(body, {.ticks = 20000, .tool_radius_m = 0.005});
  for (const Eigen::Vector3d& x : path) {
    Bytes wire;
    if (tick++ % 20 == 0) {
      for (Element near : body.around(x)) {
        near.sequence = ++sequence;
        add(wire, near);
        if (random() % 3 == 0) {
          wire[wire.size() - 1 - random() % kWireBytes] ^= std::byte{0x10};
        }
      }
    }
    for (std::span<const std::byte> bytes(wire); !bytes.empty();) {
      if (receive(receiver, bytes, out)) {
        accept(state, out);
      }
    }
    contacts += step(state, {x, 0}, 0.0005).in_contact ? 1 : 0;
    ASSERT_GE(state.ledger.work_j, -1e-12);
  }
  EXPECT_EQ(state.safety.fault, Fault::kNone);
  EXPECT_GT(receiver.counts.broken, 1000U);
  EXPECT_GT(receiver.counts.accepted, 5000U);
  EXPECT_GT(contacts, 5000);
}

}  // namespace
}  // namespace palpate
