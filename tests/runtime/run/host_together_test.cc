// Two hands of a host are the coupled set itself, to the bit.
#include <array>
#include <cmath>
#include <memory>

#include <gtest/gtest.h>

#include "runtime/c_api/host_body.h"
#include "runtime/slow/contact_elements.h"
#include "runtime/slow/coupled_storage.h"
#include "tests/support/padded_plate.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

constexpr double kHostTickS = 0.001;

// Hands that come down, rock and slide towards each other.
std::array<HostSample, 2> hands_at(int tick) {
  const double t = 0.001 * tick;
  const double z = 0.003 + 0.002 * std::cos(3.0 * t);
  std::array<HostSample, 2> hands;
  hands[0].position_m = {-0.016 + 0.002 * std::sin(t), 0.001, z};
  hands[1].position_m = {0.018 - 0.004 * std::sin(2.0 * t), 0.002, z + 1e-4};
  hands[1].quaternion = {0.0, 0.05 * std::sin(5.0 * t), 0.1 * t, 2.0};
  return hands;
}

PortPose pose_of(const HostSample& hand) {
  const Eigen::Vector4d q =
      hand.quaternion.isZero()
          ? Eigen::Vector4d(0.0, 0.0, 0.0, 1.0)
          : Eigen::Vector4d(hand.quaternion / hand.quaternion.stableNorm());
  return {hand.position_m,
          Eigen::Quaterniond(q.w(), q.x(), q.y(), q.z()).toRotationMatrix()};
}

TEST(HostTogether, IsTheCoupledSetToTheBit) {
  const ScratchFolder folder;
  const ResponseDatabase database = padded_plate(3);
  write_database(folder / "pads.h5", database);
  HostOptions options;
  options.tool = "ball";
  options.own_slow_steps = true;
  HostBody body(folder / "pads.h5", options);
  HostTool& host = body.add_together("pads").tool;

  const ResponseTable* const tools[] = {&find_tool(database, "ball"),
                                        &find_tool(database, "pads")};
  ContactStream stream(database, tools);
  FastConfig fast;
  fast.model = LocalModel::kPotential;
  fast.force_max_n = options.force_max_n;
  fast.ramp_s = options.ramp_s;
  CoupledStorage storage(stream.set(), fast);
  const auto fifo = std::make_unique<ContactFifo>();
  ContactSent sent;

  int contacts = 0;
  for (int tick = 0; tick < 3000; ++tick) {
    const std::array<HostSample, 2> hands = hands_at(tick);
    const HostTick given = host.step(hands);
    while (const ContactElement* message = fifo->front()) {
      accept(storage.state(), *message);
      fifo->pop();
    }
    PoseSample sample;
    sample.pose = {pose_of(hands[0]), pose_of(hands[1])};
    const WrenchCommand set = step(storage.state(), sample, kHostTickS);
    ASSERT_EQ(given.command.wrench[0].force_n, set.wrench[0].force_n) << tick;
    ASSERT_EQ(given.command.wrench[1].force_n, set.wrench[1].force_n) << tick;
    ASSERT_EQ(given.command.wrench[0].torque_n_m, set.wrench[0].torque_n_m) << tick;
    ASSERT_EQ(given.command.wrench[1].torque_n_m, set.wrench[1].torque_n_m) << tick;
    ASSERT_EQ(given.work_j, account_of(storage.state()).work_j) << tick;
    contacts = std::max(contacts, set.contacts);
    if (tick % 10 == 0) {
      (void)body.slow_step();
      (void)stream.update(
          contact_tool_state(storage.state(), static_cast<std::uint64_t>(tick + 1)), 0,
          *fifo, sent);
    }
  }
  EXPECT_EQ(contacts, 4);
}

}  // namespace
}  // namespace palpate
