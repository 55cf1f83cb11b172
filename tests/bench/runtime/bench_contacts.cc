#include "tests/bench/runtime/bench_contacts.h"

#include <algorithm>
#include <chrono>
#include <limits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/json_text.h"
#include "formats/base/quantile.h"
#include "runtime/slow/coupled_storage.h"
#include "tests/bench/runtime/contact_walk.h"

namespace palpate {
namespace {

using SteadyClock = std::chrono::steady_clock;

constexpr double kRadiusM = 0.003;

double elapsed_us(SteadyClock::time_point from) {
  return std::chrono::duration<double, std::micro>(SteadyClock::now() - from).count();
}

double percentile(std::vector<double> values, double share) {
  if (values.empty()) {
    return 0.0;
  }
  std::sort(values.begin(), values.end());
  return quantile(values, share);
}

double clock_cost_us() {
  std::vector<double> empty(10001);
  for (double& value : empty) {
    value = elapsed_us(SteadyClock::now());
  }
  return percentile(empty, 0.5);
}

ContactBody body_of(const ContactsBenchRow& row) {
  BenchBodyOptions options{.wave_m = 0.001,
                           .contrast = 9.0,
                           .tilt_rad = 0.1,
                           .friction_min = row.friction,
                           .friction_max = row.friction};
  if (row.relaxing) {  // pork, as bench_step.cc has it
    options.relaxing = {0.258, 0.303};
    options.relaxation_s = {0.42, 4.5};
  }
  ContactBody body = make_contact_body(options, kRadiusM);
  for (ContactRow& one : body.row) {
    if (!row.coupled) {
      one.value.fill(0.0F);
    }
  }
  return body;
}

void count(const CoupledState& state, const WrenchCommand& command,
           ContactsBenchRow& row) {
  const CoupledContacts& c = state.model.field.equilibrium;
  row.touching += command.contacts;
  row.evaluations += c.evaluations;
  row.factorings += c.factorings;
  row.force_max_n = std::max(row.force_max_n, command.wrench[0].force_n.norm());
  row.scaled = row.scaled || command.scaled;
}

void run(const ContactsBenchOptions& options, std::uint64_t (*allocations)(),
         ContactsBenchRow& row) {
  const ContactBody body = body_of(row);
  FastConfig config;
  config.model = options.facets ? LocalModel::kFacets : LocalModel::kPotential;
  config.force_max_n = 1e9;
  config.slew_max_n_per_s = std::numeric_limits<double>::infinity();
  CoupledStorage storage(
      make_plate(body, row.contacts, row.contacts == 64 ? 0.005 : 0.006, kRadiusM),
      config);
  CoupledState& state = storage.state();
  PoseWalk walk(body, 1, {.seed = 5});
  std::vector<double> us;
  us.reserve(static_cast<std::size_t>(options.ticks));
  const double clock_us = clock_cost_us();
  for (int tick = 0; tick < options.ticks; ++tick) {
    const PortPoses& pose = walk.next();
    for (int i = 0; i < row.contacts && tick % options.ticks_per_slow == 0; ++i) {
      send(state, body, pose, i);
    }
    const std::uint64_t before = allocations();
    const auto from = SteadyClock::now();
    const WrenchCommand command = step(state, {pose, 0}, PoseWalk::kTickS);
    const double took_us = elapsed_us(from) - clock_us;
    row.allocations += allocations() - before;
    row.lowest_work_j = std::min(row.lowest_work_j, state.ledger.work_j);
    if (command.in_contact) {
      us.push_back(took_us);
      count(state, command, row);
    }
  }
  const double ticks = std::max(1.0, static_cast<double>(us.size()));
  row.touching /= ticks;
  row.evaluations /= ticks;
  row.factorings /= ticks;
  row.median_us = percentile(us, 0.5);
  row.p999_us = percentile(us, 0.999);
}

std::vector<ContactsBenchRow> rows_of(int contacts) {
  return {{.contacts = contacts},
          {.contacts = contacts, .friction = 0.5},
          {.contacts = contacts, .coupled = true},
          {.contacts = contacts, .coupled = true, .friction = 0.5},
          {.contacts = contacts, .coupled = true, .relaxing = true, .friction = 0.5}};
}

}  // namespace

std::vector<ContactsBenchRow> run_contacts_bench(const ContactsBenchOptions& options,
                                                 std::uint64_t (*allocations)()) {
  std::vector<ContactsBenchRow> rows;
  for (const int contacts : {1, 4, 16, 64}) {
    for (ContactsBenchRow& row : rows_of(contacts)) {
      run(options, allocations, row);
      rows.push_back(row);
    }
  }
  return rows;
}

std::string table_text(const std::vector<ContactsBenchRow>& rows) {
  std::string text = fmt::format(
      "{:>8} {:>8} {:>8} {:>8} {:>10} {:>10} {:>8} {:>6} {:>6} {:>9} {:>10} {:>6} "
      "{:>6}\n",
      "contacts", "coupled", "relaxing", "friction", "median us", "99.9 % us",
      "touching", "eval", "factor", "force N", "work J", "scaled", "allocs");
  for (const ContactsBenchRow& row : rows) {
    text += fmt::format(
        "{:>8} {:>8} {:>8} {:>8.2g} {:>10.3f} {:>10.3f} {:>8.1f} {:>6.2f} {:>6.2f} "
        "{:>9.3f} {:>10.1e} {:>6} {:>6}\n",
        row.contacts, row.coupled ? "yes" : "no", row.relaxing ? "yes" : "no",
        row.friction, row.median_us, row.p999_us, row.touching, row.evaluations,
        row.factorings, row.force_max_n, row.lowest_work_j, row.scaled ? "yes" : "no",
        row.allocations);
  }
  return text;
}

std::string to_json(const std::vector<ContactsBenchRow>& rows) {
  nlohmann::json json = nlohmann::json::array();
  for (const ContactsBenchRow& row : rows) {
    json.push_back({{"contacts", row.contacts},
                    {"coupled", row.coupled},
                    {"relaxing", row.relaxing},
                    {"friction", row.friction},
                    {"median_us", row.median_us},
                    {"p999_us", row.p999_us},
                    {"touching", row.touching},
                    {"evaluations", row.evaluations},
                    {"factorings", row.factorings},
                    {"force_max_n", row.force_max_n},
                    {"lowest_work_j", row.lowest_work_j},
                    {"scaled", row.scaled},
                    {"allocations", row.allocations}});
  }
  return json_text(nlohmann::json{{"rows", json}}, 2);
}

}  // namespace palpate
