// A host's needle is the fast step itself, to the bit.
#include <cmath>
#include <memory>

#include <gtest/gtest.h>

#include "runtime/c_api/host_body.h"
#include "runtime/slow/response_source.h"
#include "tests/support/punctured_plate.h"

namespace palpate {
namespace {

TEST(HostNeedle, IsTheFastStepToTheBit) {
  const auto database = std::make_shared<const ResponseDatabase>(punctured_plate());
  HostOptions options;
  options.own_slow_steps = true;
  HostBody body(database, options);
  HostTool& host = body.add_tool();
  const auto stream =
      responses_in_memory(*database)->elements("ball", 1.0, Eigen::Vector3d::Zero());
  const auto fast = std::make_unique<FastState>();
  fast->config.model = LocalModel::kPotential;
  fast->config.tool_radius_m = kPlateNeedleM;
  fast->config.force_max_n = options.force_max_n;
  fast->config.ramp_s = options.ramp_s;
  fast->config.puncture = stream->puncture();
  const auto fifo = std::make_unique<ElementFifo>();
  for (int tick = 1; tick <= 4000; ++tick) {
    // In and out twice, once aside.
    const double t = 0.001 * tick;
    const Eigen::Vector3d x(0.001 + 2e-4 * std::sin(9.0 * t), 0.002,
                            kPlateNeedleM - 0.006 + 0.008 * std::cos(3.0 * t));
    const HostTick given = host.step({.position_m = x, .dt_s = 0.001});
    while (const Element* element = fifo->front()) {
      accept(*fast, *element);
      fifo->pop();
    }
    const FastCommand command = step(*fast, {x, 0}, 0.001);
    ASSERT_EQ(given.command.wrench[0].force_n, command.force_n) << tick;
    ASSERT_EQ(given.work_j, fast->ledger.work_j) << tick;
    if (tick % 5 == 0) {
      (void)body.slow_step();
      (void)stream->update({.sequence = static_cast<std::uint64_t>(tick),
                            .position_m = contact(*fast).tool_m,
                            .triangle = active_triangle(*fast),
                            .in_contact = fast->in_contact},
                           0, *fifo);
    }
  }
  const NeedleSeen seen = host.needle();
  ASSERT_TRUE(seen.punctures);
  EXPECT_EQ(seen.state.channels, fast->needle.channels);
  EXPECT_GT(seen.state.broken, 0U);
  EXPECT_EQ(seen.state.crack_j, fast->needle.crack_j);
  EXPECT_EQ(host.channel_at(0).depth_m, fast->needle.channel[0].depth_m);
}

}  // namespace
}  // namespace palpate
