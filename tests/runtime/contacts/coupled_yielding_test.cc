// Several contacts on a body that yields: the first press, dents that all find, walks.
#include "runtime/contacts/coupled_yielding.h"

#include <cmath>
#include <cstdlib>
#include <memory>
#include <random>

#include <gtest/gtest.h>

#include "tests/support/coupled_plate.h"

namespace palpate {
namespace {

BenchBodyOptions yielding(BenchBodyOptions options, bool softens) {
  options.yielding = NodeYielding{.yield_depth_m = 0.0004, .share = 0.4};
  if (softens) {
    options.yielding->onset_m = 0.0005;
    options.yielding->scale_m = 0.003;
    options.yielding->largest = 0.4;
  }
  return options;
}

double borne_n(const CoupledState& state, int i) {
  return state.model.field.equilibrium.force_n(i);
}

// Pads far enough apart that no site is that of two.
CoupledSet far_apart(const ContactBody& body, int contacts) {
  return make_plate(body, contacts, 0.015, kRadiusM);
}

PortPoses at_height(double z_m, double x_m = 0.0301) {
  PortPoses pose;
  pose[0].position_m = {x_m, 0.0303, kRadiusM + z_m};
  return pose;
}

// A first press bears what the stored curves say, coupled; what is lifted then is
// elastic from the dents that it left.
TEST(CoupledYielding, AFirstPressIsTheStoredResponse) {
  const ContactBody body = make_contact_body(yielding({}, false), kRadiusM);
  const ContactBody plain = make_contact_body({}, kRadiusM);
  CoupledStorage storage(far_apart(body, 4), free_of_clamps());
  CoupledStorage elastic(far_apart(plain, 4), free_of_clamps());
  CoupledState& state = storage.state();
  double lifted_n = 0.0;
  for (int tick = 0; tick <= 800; ++tick) {
    const double z = tick <= 500 ? 0.0005 - 5e-6 * tick : -0.002 + 5e-6 * (tick - 500);
    const PortPoses pose = at_height(z);
    if (tick == 0) {
      send_all(state, body, pose);
      send_all(elastic.state(), plain, pose);
    }
    (void)step(state, {pose, 0}, kTickS);
    const WrenchCommand stored = step(elastic.state(), {pose, 0}, kTickS);
    for (int i = 0; i < 4; ++i) {
      const double wanted = borne_n(elastic.state(), i);
      if (tick <= 500) {
        // A tick's last round leaves some of what it asks for.
        EXPECT_NEAR(borne_n(state, i), wanted, 1e-4 * wanted + 1e-9) << tick;
      }
    }
    if (tick == 700) {
      lifted_n = stored.wrench[0].force_n.z();
    }
  }
  ASSERT_GT(lifted_n, 0.1);
  const WrenchCommand lifted = step(state, {at_height(-0.001), 0}, kTickS);
  EXPECT_LT(lifted.wrench[0].force_n.z(), 0.7 * lifted_n);
  EXPECT_GT(lifted.wrench[0].force_n.z(), 0.0);
  // D = r (delta - Y) of the depth that the others left each.
  const Real dent_m = state.model.field.memory[0].yielded.dent_m.value;
  EXPECT_GT(dent_m, 0.4 * (0.0012 - 0.0004));
  EXPECT_LT(dent_m, 0.4 * (0.0020 - 0.0004));
  EXPECT_GT(state.ledger.yielded_j, 1e-6);
}

// The second pad comes to where the first one was.
TEST(CoupledYielding, ContactsFindEachOthersDents) {
  const ContactBody body = make_contact_body(yielding({}, true), kRadiusM);
  double first_n = 0.0;
  for (const bool pressed_before : {false, true}) {
    CoupledStorage storage(far_apart(body, 2), free_of_clamps());
    CoupledState& state = storage.state();
    const auto press_at = [&](double x_m) {
      send_all(state, body, at_height(0.001, x_m));
      double second_n = 0.0;  // half down: at the bottom it is that of a first press
      for (int tick = 0; tick <= 300; ++tick) {
        (void)step(state, {at_height(0.001 - 1e-5 * tick, x_m), 0}, kTickS);
        second_n = tick == 200 ? borne_n(state, 1) : second_n;
      }
      for (int tick = 0; tick <= 300; ++tick) {
        (void)step(state, {at_height(-0.002 + 1e-5 * tick, x_m), 0}, kTickS);
      }
      return second_n;
    };
    if (pressed_before) {
      (void)press_at(0.0301);
      for (int tick = 0; tick <= 300; ++tick) {  // in the air
        const double x = 0.0301 - 5e-5 * tick;
        send_all(state, body, at_height(0.001, x));
        (void)step(state, {at_height(0.001, x), 0}, kTickS);
      }
    }
    const double second_n = press_at(0.0151);
    ASSERT_GT(second_n, 0.01);
    if (pressed_before) {
      EXPECT_LT(second_n, 0.6 * first_n);
    } else {
      first_n = second_n;
    }
  }
}

TEST(CoupledYielding, WrenchIsTheGradient) {
  BenchBodyOptions options = yielding(rough(), true);
  options.relaxing = {0.45, 0.35};
  options.relaxation_s = {0.06, 4.0};
  ContactBody body = make_contact_body(options, kRadiusM);
  add_modes(body, 0.3);
  const CoupledSet set = make_plate(body, 4, 0.006, kRadiusM);
  CoupledStorage storage(set, free_of_clamps());
  CoupledState& state = storage.state();
  PoseWalk walk(body, 1, {.depth_m = 0.003, .seed = 3});
  int tried = 0;
  for (int tick = 0; tick < 12000; ++tick) {
    const PortPoses& pose = walk.next();
    if (tick % 20 == 0) {
      send_all(state, body, pose);
    }
    const WrenchCommand command = step(state, {pose, 0}, kTickS);
    if (tick % 97 == 5 && command.contacts > 1) {
      expect_gradient(state, pose, command, set.lever_m[0]);
      ++tried;
    }
  }
  EXPECT_GT(tried, 20);
  EXPECT_GT(state.ledger.yielded_j, 1e-5);
}

// What every contact has at hand is what the table of all says.
void expect_one_table(const CoupledState& state) {
  const YieldedSites& table = state.surfaces[0].memory.yielded;
  for (int i = 0; i < state.set.count; ++i) {
    const SitesAtHand& sites =
        state.model.field.memory[static_cast<std::size_t>(i)].sites;
    for (std::size_t n = 0; n < sites.count; ++n) {
      if (const int row = find_yielded(table, sites.site[n]); row >= 0) {
        const YieldedSite& stayed = table.row[static_cast<std::size_t>(row)];
        ASSERT_EQ(sites.dent_m[n], stayed.dent_m);
        ASSERT_EQ(sites.softened_m[n], stayed.softened_m);
      }
    }
  }
}

// 1.5 x 10^4 ticks; PALPATE_LONG_WALK=10000000 for the capability's.
TEST(CoupledYielding, PoseWalksNeverGetEnergy) {
  const char* longer = std::getenv("PALPATE_LONG_WALK");
  const std::int64_t ticks = longer != nullptr ? std::atoll(longer) : 15000;
  for (const bool relaxes : {false, true}) {
    BenchBodyOptions options = yielding(rough(0.4), true);
    if (relaxes) {
      options.relaxing = {0.45, 0.35};
      options.relaxation_s = {0.06, 4.0};
    }
    ContactBody body = make_contact_body(options, kRadiusM);
    add_modes(body, 0.3);
    CoupledStorage storage(make_plate(body, 4, 0.006, kRadiusM), free_of_clamps());
    CoupledState& state = storage.state();
    PoseWalk walk(body, 1, {.depth_m = 0.004, .seed = 7});
    CoupledAccount account;
    std::mt19937_64 random(2);
    std::uniform_real_distribution<double> uniform;
    double yielded_j = 0.0;
    const auto before = std::make_unique<YieldedSites>();
    for (std::int64_t tick = 0; tick < ticks; ++tick) {
      const PortPoses& pose = walk.next();
      for (int i = 0; i < state.set.count && tick % 20 == 0; ++i) {
        if (uniform(random) < 0.8) {
          send(state, body, pose, i);
        }
      }
      const double dt_s = kTickS * (0.2 + 1.6 * uniform(random));
      const WrenchCommand command = account.step(state, pose, dt_s);
      EXPECT_GE(command.yielded_j, yielded_j);
      if (command.yielded_j > yielded_j) {
        expect_one_table(state);
        const YieldedSites& table = state.surfaces[0].memory.yielded;
        for (std::size_t row = 0; row < table.row.size(); ++row) {
          ASSERT_GE(table.row[row].dent_m, before->row[row].dent_m);
          ASSERT_GE(table.row[row].softened_m, before->row[row].softened_m);
        }
        *before = table;
      }
      yielded_j = command.yielded_j;
    }
    EXPECT_EQ(state.safety.fault, Fault::kNone);
    EXPECT_GE(account.lowest_j, -1e-12);
    EXPECT_NEAR(imbalance_j(state.ledger), 0.0,
                1e-12 * std::sqrt(static_cast<double>(ticks) / 1e4));
    EXPECT_LE(state.ledger.created_j, 1e-15 * static_cast<double>(ticks) / 1e3);
    EXPECT_GT(yielded_j, 1e-5);
    EXPECT_EQ(state.model.field.equilibrium.scale, 1.0);
  }
}

}  // namespace
}  // namespace palpate
