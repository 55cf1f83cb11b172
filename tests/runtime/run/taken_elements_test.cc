// However many elements wait, a tick takes in no more than its time allows.
#include <memory>
#include <utility>

#include <gtest/gtest.h>

#include "runtime/c_api/host_tool.h"
#include "runtime/render/fast_process.h"
#include "runtime/render/several_contacts.h"
#include "tests/support/padded_plate.h"
#include "tests/support/pressed_plate.h"

namespace palpate {
namespace {

constexpr int kMany = 64;

// As padded_plate(), of so many pads that a leap makes hundreds of elements.
ResponseDatabase many_pads() {
  ResponseDatabase database = padded_plate(kMany);
  Points& point_m = database.tools[1].tool.contact.point_m;
  for (int i = 0; i < kMany; ++i) {
    point_m.row(i) << 0.011 * (i % 8 - 3.5), 0.011 * (i / 8 - 3.5), 0.0;
  }
  return database;
}

TEST(TakenElements, OfAHostsToolAreBoundedInATick) {
  const ResponseDatabase database = many_pads();
  const ResponseTable* const tools[] = {&find_tool(database, "pads")};
  FastConfig fast;
  fast.model = LocalModel::kPotential;
  auto body = std::make_unique<SeveralContacts>(database, tools, fast);
  SeveralContacts& pads = *body;
  const BodyPlacement here;
  HostTool host(std::move(body), {"pads"}, here, 0.001, 0.5);
  const HostSample high{.position_m = {0.0, 0.0, 0.02}};
  (void)host.step(high);
  std::size_t waiting = host.serve(0);
  ASSERT_GT(waiting, 8U * kMany);
  for (int tick = 0; tick < 3; ++tick) {
    (void)host.step(high);
    waiting -= kElementsATick;
  }
  std::size_t left = 0;
  ArrivalRecord arrival;
  while (pads.take_in(arrival)) {
    ++left;
  }
  EXPECT_EQ(left, waiting);
}

TEST(TakenElements, OfADevicesToolAreBoundedInATick) {
  const ResponseDatabase database = many_pads();
  const RenderConfig c = config(LocalModel::kPotential);
  const ResponseTable* const pads[] = {&find_tool(database, "pads")};
  SeveralContacts body(database, pads, c.fast.fast);
  FakeClock clock(1'000'000);
  FakeDevice device(clock, press(0.004, 2.0));
  FlightLog flight;
  FastProcess process(c.fast, device, body, {.flight = &flight});
  for (int tick = 0; tick < 40; ++tick) {
    clock.sleep_until_ns(clock.now_ns() + 500'000);
    ASSERT_TRUE(process.tick(0));
    if (tick == 0) {
      EXPECT_TRUE(body.serve(clock.now_ns()).has_value());
    }
  }
  std::vector<int> taken(40);
  for (const ArrivalRecord& arrival : flight.arrivals.values()) {
    ++taken[static_cast<std::size_t>(arrival.tick)];
  }
  EXPECT_EQ(taken[1], kElementsATick);
  EXPECT_EQ(taken[8], kElementsATick);
  EXPECT_EQ(taken[39], 0);
}

}  // namespace
}  // namespace palpate
