#include "runtime/c_api/given_options.h"

#include <cmath>
#include <cstddef>
#include <cstring>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "tests/support/said.h"

namespace palpate {
namespace {

palpate_options zero_options() {
  palpate_options options{};
  options.struct_size = sizeof options;
  return options;
}

void expect_defaults(const HostOptions& options) {
  const HostOptions defaults;
  EXPECT_EQ(options.tool, defaults.tool);
  EXPECT_EQ(options.model, defaults.model);
  EXPECT_EQ(options.metres_per_unit, 1.0);
  EXPECT_EQ(options.newtons_per_unit, 1.0);
  EXPECT_EQ(options.position_gain, 1.0);
  EXPECT_EQ(options.force_gain, 1.0);
  EXPECT_EQ(options.tick_s, 0.001);
  EXPECT_EQ(options.slow_hz, 100.0);
  EXPECT_EQ(options.damping_n_s_per_m, 0.0);
  EXPECT_EQ(options.angular_damping_n_m_s, 0.0);
  EXPECT_EQ(options.delay_s, 0.0);
  EXPECT_EQ(options.force_max_n, 8.0);
  EXPECT_EQ(options.stall_s, 0.5);
  EXPECT_EQ(options.ramp_s, 0.1);
  EXPECT_FALSE(options.own_slow_steps || options.limit_stiffness || options.streamed ||
               options.scene || options.estimate || options.forces_alone);
  EXPECT_TRUE(options.server.empty() && options.output.empty());
}

TEST(GivenOptions, NoneAndZerosAreTheHeadersDefaults) {
  const palpate_options zeros = zero_options();
  expect_defaults(host_options(nullptr));
  expect_defaults(host_options(&zeros));
}

TEST(GivenOptions, EveryNumberGoesWhereItBelongs) {
  palpate_options given = zero_options();
  double value = 1.0;
  for (double* const member :
       {&given.metres_per_unit, &given.newtons_per_unit, &given.position_gain,
        &given.force_gain, &given.nominal_tick_s, &given.slow_hz,
        &given.device_damping_n_s_per_m, &given.device_delay_s, &given.force_max_n,
        &given.stall_s, &given.ramp_s, &given.device_angular_damping_n_m_s}) {
    *member = value += 1.0;
  }
  const HostOptions options = host_options(&given);
  value = 1.0;
  for (const double taken :
       {options.metres_per_unit, options.newtons_per_unit, options.position_gain,
        options.force_gain, options.tick_s, options.slow_hz, options.damping_n_s_per_m,
        options.delay_s, options.force_max_n, options.stall_s, options.ramp_s,
        options.angular_damping_n_m_s}) {
    EXPECT_EQ(taken, value += 1.0);
  }
}

TEST(GivenOptions, NaNIsTakenSoThatItIsRefusedLater) {
  palpate_options given = zero_options();
  given.force_max_n = std::nan("");
  const HostOptions options = host_options(&given);
  EXPECT_TRUE(std::isnan(options.force_max_n));
  EXPECT_THROW(check(options), InputError);
}

TEST(GivenOptions, EveryFlagIsItsOwn) {
  const auto with = [](std::uint32_t flags) {
    palpate_options given = zero_options();
    given.flags = flags;
    const HostOptions o = host_options(&given);
    return std::array{o.own_slow_steps, o.limit_stiffness, o.streamed,
                      o.scene,          o.estimate,        o.forces_alone};
  };
  const std::array flags{PALPATE_OWN_SLOW_STEPS, PALPATE_LIMIT_STIFFNESS,
                         PALPATE_STREAMED,       PALPATE_SCENE,
                         PALPATE_ESTIMATE,       PALPATE_FORCES_ALONE};
  for (std::size_t i = 0; i < flags.size(); ++i) {
    std::array<bool, 6> wanted{};
    wanted[i] = true;
    EXPECT_EQ(with(flags[i]), wanted) << i;
  }
}

TEST(GivenOptions, AFlagOfANewerHeaderIsRefused) {
  palpate_options given = zero_options();
  given.flags = 64 | PALPATE_STREAMED;
  EXPECT_THROW((void)host_options(&given), InputError);
  EXPECT_EQ(refusal([&] {
              (void)host_options(&given);
            }),
            "flags are 0x44, known are 0x3f");
}

TEST(GivenOptions, TextsAreTakenAndModelsLookedUp) {
  palpate_options given = zero_options();
  given.tool_name = "ball";
  given.model = "facets";
  given.server = "/bin/serve";
  given.output = "it.h5";
  const HostOptions options = host_options(&given);
  EXPECT_EQ(options.tool, "ball");
  EXPECT_EQ(options.model, LocalModel::kFacets);
  EXPECT_EQ(options.server, "/bin/serve");
  EXPECT_EQ(options.output, "it.h5");
  for (const char* name : {"single", "first-order-hold", "Facets", ""}) {
    given.model = name;
    expect_says(refusal([&] {
                  (void)host_options(&given);
                }),
                std::string("model \"") + name + "\" is none of the passive ones: ");
  }
}

TEST(GivenOptions, AnOlderHeadersMembersEndWhereItsStructDoes) {
  palpate_options given = zero_options();
  given.stall_s = 0.25;
  given.flags = 64;  // not known to its caller: whatever lies there
  given.model = "nonsense";
  given.struct_size = offsetof(palpate_options, flags);
  const HostOptions options = host_options(&given);
  EXPECT_EQ(options.stall_s, 0.25);
  EXPECT_EQ(options.model, LocalModel::kPotential);
  given.struct_size = offsetof(palpate_options, tool_name);
  expect_defaults(host_options(&given));
}

TEST(GivenOptions, AForgottenSizeIsRefused) {
  palpate_options given = zero_options();
  for (const std::size_t size : {std::size_t{0}, sizeof(std::size_t) - 1}) {
    given.struct_size = size;
    EXPECT_EQ(refusal([&] {
                (void)host_options(&given);
              }),
              "struct_size of the options is " + std::to_string(size) +
                  ", must be sizeof(palpate_options)");
  }
}

struct NewerOptions {
  palpate_options known;
  unsigned char more[8];
};

TEST(GivenOptions, ANewerHeadersMembersMustBeZero) {
  NewerOptions given{};
  given.known.struct_size = sizeof given;
  expect_defaults(host_options(&given.known));
  for (const std::size_t byte : {std::size_t{0}, std::size_t{7}}) {
    given = {};
    given.known.struct_size = sizeof given;
    given.more[byte] = 1;
    expect_says(refusal([&] {
                  (void)host_options(&given.known);
                }),
                "byte " + std::to_string(sizeof(palpate_options) + byte) +
                    " of the options is set");
  }
}

}  // namespace
}  // namespace palpate
