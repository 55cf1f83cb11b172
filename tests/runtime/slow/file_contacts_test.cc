// Several contacts on a streamed body get what the whole one gives, within the budget.
#include "runtime/slow/file_contacts.h"

#include <random>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "runtime/slow/file_elements.h"
#include "runtime/slow/response_source.h"
#include "tests/support/padded_plate.h"
#include "tests/support/quiet_exit.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

constexpr double kBall = 0.05;

// A ball of responses and rows of compliance that differ from node to node, pressed by
// pads of two radii.
ResponseDatabase two_radii() {
  const auto wavy = [](Eigen::Index node, double d) {
    return (100.0 + static_cast<double>(node % 17) + 1e-4 * static_cast<double>(node)) *
           d;
  };
  ResponseDatabase database = sample_database(
      sphere_surface(kBall, 5), ball(kPadRadius, 0.3, 5e-4), wavy, 0.01, 21);
  ResponseTable& responses = database.tools[0];
  ComplianceTable rows = half_space(responses.nodes());
  rows.mode = RowsOf<float>::Random(responses.nodes(), 2);
  for (Eigen::Index i = 0; i < rows.value.rows(); ++i) {
    rows.value.row(i) *= 1.0F + 0.01F * static_cast<float>(i % 23);
  }
  rows.added_modes = 1;
  responses.compliance = rows;
  ResponseTable small = responses;
  small.compliance = {};
  small.tool.name = "pads.2";
  small.tool.radius_m = 0.003;
  for (std::size_t i = 0; i < small.force_n.size(); ++i) {
    small.force_n[i] *= 0.5;
    small.energy_j[i] *= 0.5;
    small.stiffness_n_per_m[i] *= 0.5;
  }
  for (double& stiffness_n_per_m : small.stiffness_max_n_per_m) {
    stiffness_n_per_m *= 0.5;
  }
  ResponseTable set = responses;
  set.tool = pads(3);
  set.tool.contact.radius_m[1] = 0.003;
  database.tools = {set, small, responses};
  database.storage = {.precision = Precision::kFloat64, .chunk_nodes = 64};
  return database;
}

void expect_same_message(const ContactElement& a, const ContactElement& b) {
  ASSERT_EQ(a.contact, b.contact);
  EXPECT_EQ(a.element.neighbour, b.element.neighbour);
  for (std::size_t j = 0; j < 3; ++j) {
    EXPECT_EQ(a.element.node[j].position_m, b.element.node[j].position_m);
    EXPECT_EQ(a.element.node[j].force_n, b.element.node[j].force_n);
    EXPECT_EQ(a.element.node[j].energy_j, b.element.node[j].energy_j);
    EXPECT_EQ(a.row[j].value, b.row[j].value);
    EXPECT_EQ(a.row[j].mode, b.row[j].mode);
  }
}

class FileContacts : public testing::Test {
 protected:
  FileContacts() { write_database(file_, two_radii()); }

  // Contacts of tools that wander, each hand by itself.
  ContactToolState next(const CoupledSet& set) {
    std::normal_distribution<double> normal;
    ContactToolState state;
    state.sequence = ++ticks_;
    state.count = set.count;
    for (std::size_t hand = 0; hand < 2; ++hand) {
      for (Eigen::Index k = 0; k < 3; ++k) {
        heading_[hand](k) += 0.3 * normal(random_);
      }
      heading_[hand].normalize();
      at_[hand] = (at_[hand] + 0.05 * heading_[hand]).normalized();
    }
    PortPoses pose;
    for (std::size_t hand = 0; hand < pose.size(); ++hand) {
      pose[hand].position_m = 1.05 * kBall * at_[hand];
    }
    for (int i = 0; i < set.count; ++i) {
      ToolState& contact = state.contact[static_cast<std::size_t>(i)];
      contact.time_ns = static_cast<std::int64_t>(ticks_) * 10'000'000;
      contact.position_m = centre_of(set, pose, i);
      contact.triangle = triangle_[static_cast<std::size_t>(i)];
      contact.in_contact = contact.triangle >= 0 && ticks_ % 50 > 10;
    }
    return state;
  }

  // Of all tools, along a walk of both.
  void expect_same_on_a_walk(const std::vector<std::string>& names, int steps) {
    const ResponseDatabase whole = read_database(file_);
    std::vector<const ResponseTable*> tools;
    for (const std::string& name : names) {
      tools.push_back(&find_tool(whole, name));
    }
    ContactStream memory(whole, tools, cache_.force_scale);
    const auto streamed = streamed_contacts(read_index(file_), file_, names, cache_,
                                            {0, 0, kBall}, false);
    EXPECT_EQ(streamed->tables(), memory.tables());
    ContactSent sent;
    const SurfaceSearch search(whole.body);
    for (int i = 0; i < steps; ++i) {
      const ContactToolState state = next(memory.set());
      streamed->update(state, i, *fifo_, sent);
      for (; const ContactElement* message = fifo_->front(); fifo_->pop()) {
        const auto self = static_cast<std::size_t>(message->contact);
        const std::int32_t triangle = message->element.triangle;
        expect_same_message(*message, memory.element(message->contact, triangle));
        if (message->element.active) {
          triangle_[self] = triangle;
          const Eigen::Vector3d& at_m = state.contact[self].position_m;
          Eigen::Matrix3d corner;
          for (Eigen::Index j = 0; j < 3; ++j) {
            corner.row(j) = whole.body.position_m.row(whole.body.triangle(triangle, j));
          }
          EXPECT_NEAR(nearest_in_triangle(corner, at_m).distance_m,
                      search.nearest(at_m).distance_m, 1e-15);
        }
      }
    }
    for (const auto& table : streamed->elements()) {
      total_.add(dynamic_cast<const StreamedElements&>(*table).report());
    }
  }

  const ScratchFolder folder_;
  const std::filesystem::path file_ = folder_ / "pads.h5";
  const std::unique_ptr<ContactFifo> fifo_ = std::make_unique<ContactFifo>();
  CacheOptions cache_{.budget_bytes = 36 * kMebibyte};
  StreamReport total_;
  std::mt19937 random_{5};
  std::uint64_t ticks_ = 0;
  std::array<Eigen::Vector3d, 2> at_{Eigen::Vector3d::UnitZ(),
                                     Eigen::Vector3d::UnitX()};
  std::array<Eigen::Vector3d, 2> heading_{Eigen::Vector3d::UnitX(),
                                          Eigen::Vector3d::UnitY()};
  std::array<std::int32_t, kContactsMax> triangle_ = filled();
  static std::array<std::int32_t, kContactsMax> filled() {
    std::array<std::int32_t, kContactsMax> none;
    none.fill(-1);
    return none;
  }
};

TEST_F(FileContacts, GetBitForBitWhatTheWholeBodyGives) {
  expect_same_on_a_walk({"pads"}, 400);
  EXPECT_EQ(total_.starved, 0);
  EXPECT_EQ(total_.updates, 3 * 400);
  EXPECT_GT(total_.cache.evicted, 0);
  EXPECT_LE(total_.cache.bytes_max, cache_.budget_bytes);
  EXPECT_EQ(total_.fault, "");
}

TEST_F(FileContacts, OfTwoHandsLieWhereEachIs) {
  cache_.force_scale = 0.37;
  expect_same_on_a_walk({"pads", "ball"}, 300);
  EXPECT_EQ(total_.starved, 0);
  EXPECT_EQ(total_.updates, 4 * 300);
  EXPECT_LE(total_.cache.bytes_max, cache_.budget_bytes);
}

// The same nodes are the stiffest, with their rows of compliance.
TEST_F(FileContacts, AreAsStiffAsInMemory) {
  const ResponseDatabase whole = read_database(file_);
  const auto in_memory = responses_in_memory(whole);
  const auto in_file = responses_in_file(file_, cache_.budget_bytes, false);
  const auto stiffest = [](const ResponseSource& source) {
    return source.stiffest("pads", LocalModel::kElement, 8.0);
  };
  const std::vector<StiffestNode> memory = stiffest(*in_memory);
  const std::vector<StiffestNode> file = stiffest(*in_file);
  EXPECT_EQ(in_file->stiffness("ball", LocalModel::kElement, 8.0).normal_n_per_m,
            in_memory->stiffness("ball", LocalModel::kElement, 8.0).normal_n_per_m);
  for (const auto* source : {in_memory.get(), in_file.get()}) {
    EXPECT_EQ(source->tool("pads").compliance.knots(), 12U);
    EXPECT_EQ(source->contacts({"pads"}, 1.0, {0, 0, kBall})->tables(),
              (std::vector<std::string>{"pads", "pads.2"}));
    EXPECT_THROW((void)source->tool("thumb"), InputError);
  }
  ASSERT_EQ(file.size(), memory.size());
  for (std::size_t i = 0; i < file.size(); ++i) {
    EXPECT_EQ(file[i].stiffness.node, memory[i].stiffness.node);
    EXPECT_EQ(file[i].stiffness.normal_n_per_m, memory[i].stiffness.normal_n_per_m);
    EXPECT_EQ(file[i].row.value, memory[i].row.value);
    EXPECT_EQ(file[i].row.mode, memory[i].row.mode);
  }
  EXPECT_NE(file[0].stiffness.normal_n_per_m, file[1].stiffness.normal_n_per_m);
}

TEST_F(FileContacts, NeedABudgetForEachHandAndForHowFarTheyReach) {
  const DatabaseIndex index = read_index(file_);
  const ChunkContent ball{.tool = 2};
  const std::size_t one = least_budget(index, ball);
  const std::size_t two = least_budget(index, ball, {.hands = 2});
  const std::size_t wide = least_budget(index, ball, {.contacts = 3, .extent_m = 0.02});
  const auto times_one = [&](std::size_t bytes) {
    return static_cast<double>(bytes) / static_cast<double>(one);
  };
  EXPECT_NEAR(times_one(two), 2.0, 0.1);
  EXPECT_NEAR(times_one(wide), 3.0, 0.1);
  EXPECT_EQ(least_budget(index, ball, {.contacts = 3}), one);  // at one place
  EXPECT_GT(least_budget(index, {.tool = 2, .coupling = 0}), one);
  EXPECT_EQ(least_budget(index, ball, {.contacts = 64, .extent_m = 1.0}),
            least_budget(index, ball, {.hands = 2, .contacts = 64, .extent_m = 1.0}));
  cache_.budget_bytes = 2 * one;  // one for each radius
  const std::vector<std::string> names{"pads"};
  EXPECT_THROW(
      (void)streamed_contacts(index, file_, names, cache_, {0, 0, kBall}, false),
      InputError);
}

}  // namespace
}  // namespace palpate
