#include "runtime/slow/contact_elements.h"

#include <memory>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "runtime/slow/coupled_storage.h"
#include "tests/support/padded_plate.h"
#include "tests/support/punctured_sphere.h"

namespace palpate {
namespace {

std::vector<const ResponseTable*> tools(const ResponseDatabase& database,
                                        std::initializer_list<const char*> names) {
  std::vector<const ResponseTable*> tables;
  for (const char* name : names) {
    tables.push_back(&find_tool(database, name));
  }
  return tables;
}

// What makes of a database a sentence.
std::string refusal(const ResponseDatabase& database,
                    std::initializer_list<const char*> names) {
  try {
    (void)coupled_set(tools(database, names));
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(ContactElements, SetHasTheContactsOfItsTools) {
  const ResponseDatabase database = padded_plate(3);
  const CoupledSet one = coupled_set(tools(database, {"pads"}));
  EXPECT_EQ(one.count, 3);
  EXPECT_EQ(one.ports, 1);
  EXPECT_EQ(one.sphere[2].centre_m, Eigen::Vector3d(0.012, 0.0, 0.0));
  EXPECT_EQ(one.knots.count, 12U);
  const CoupledSet two = coupled_set(tools(database, {"pads", "ball"}));
  EXPECT_EQ(two.count, 4);
  EXPECT_EQ(two.ports, 2);
  EXPECT_EQ(two.sphere[3].port, 1);
  EXPECT_EQ(two.sphere[3].radius_m, kPadRadius);
  const CoupledSet alone = coupled_set(tools(database, {"ball"}));
  EXPECT_TRUE(is_alone(alone));
}

TEST(ContactElements, RadiiHaveTablesOfTheirOwn) {
  ResponseDatabase database = padded_plate(3);
  ResponseTable small = database.tools[0];
  small.tool.name = "pads.2";
  small.tool.radius_m = 0.003;
  database.tools[1].tool.contact.radius_m[1] = 0.003;
  database.tools.push_back(small);
  const CoupledSet set = coupled_set(tools(database, {"pads"}));
  EXPECT_EQ(set.sphere[0].table, 0);
  EXPECT_EQ(set.sphere[1].table, 1);
  EXPECT_EQ(set.sphere[1].radius_m, 0.003);
  EXPECT_EQ(set.sphere[2].table, 0);
  EXPECT_EQ(set.knots.count, 12U);
}

TEST(ContactElements, RefusesInOneSentenceWhatCannotBeRendered) {
  ResponseDatabase without = padded_plate(3, false);
  const std::string text = refusal(without, {"pads"});
  EXPECT_NE(text.find("\"pads\" has no table of compliance"), std::string::npos)
      << text;
  EXPECT_NE(text.find("shape = \"spheres\""), std::string::npos);
  EXPECT_NE(refusal(without, {"ball", "ball"}), "");
  EXPECT_EQ(refusal(without, {"ball"}), "");
  ResponseDatabase relaxing = padded_plate(3);
  Viscoelasticity& relaxation = relaxing.tools[1].viscoelasticity;
  relaxation.tau_s = {0.5};
  relaxation.g = RowsOf<float>{{0.3F}};
  relaxation.instantaneous = true;
  EXPECT_EQ(refusal(relaxing, {"pads"}), "");
  relaxation.instantaneous = false;
  relaxation.speed_m_per_s = 0.001;
  EXPECT_NE(refusal(relaxing, {"pads"}).find("of a press at 0.001 m/s"),
            std::string::npos);
  ResponseDatabase yielding = padded_plate(3);
  yielding.tools[1].viscoelasticity.yielding.largest = {0.3};
  EXPECT_EQ(refusal(yielding, {"pads"}), "");
  const ResponseDatabase many = padded_plate(64);
  EXPECT_NE(refusal(many, {"pads", "ball"}).find("more than 64"), std::string::npos);
  const ResponseDatabase plain = padded_plate(3);
  EXPECT_NE(refusal(plain, {"ball", "ball", "ball"}).find("3 tools"),
            std::string::npos);
}

// Beside another hand, or with spheres; alone it is no matter of contacts.
TEST(ContactElements, RefusesNeedles) {
  ResponseDatabase database = padded_plate(3);
  for (ResponseTable& table : database.tools) {
    table.puncture = some_puncture(1);
  }
  const std::string why = "\"ball\" is a needle, and contacts that are coupled";
  EXPECT_NE(refusal(database, {"ball", "ball"}).find(why), std::string::npos);
  EXPECT_NE(refusal(database, {"pads"}).find("\"pads\" is a needle"),
            std::string::npos);
  EXPECT_EQ(refusal(database, {"ball"}), "");
  ResponseDatabase one = padded_plate(1);
  EXPECT_EQ(refusal(one, {"pads"}), "");
  one.tools[1].puncture = some_puncture(1);
  EXPECT_NE(refusal(one, {"pads"}), "");
}

ContactToolState at_height(const CoupledSet& set, double z) {
  ContactToolState state;
  state.sequence = 1;
  state.count = set.count;
  PortPoses pose;
  pose[0].position_m = {0.001, 0.002, z};
  for (int i = 0; i < set.count; ++i) {
    state.contact[static_cast<std::size_t>(i)].position_m = centre_of(set, pose, i);
  }
  return state;
}

TEST(ContactElements, EachContactGetsWhatIsUnderIt) {
  const ResponseDatabase database = padded_plate(3);
  ContactStream stream(database, tools(database, {"pads"}));
  const auto fifo = std::make_unique<ContactFifo>();
  ContactSent sent_so_far;
  const ContactToolState state = at_height(stream.set(), 0.006);
  const std::size_t sent = stream.update(state, 7, *fifo, sent_so_far);
  EXPECT_GE(sent, 3U * 7U);
  std::array<int, 3> active{};
  std::size_t taken = 0;
  while (const ContactElement* message = fifo->front()) {
    ++taken;
    EXPECT_EQ(message->element.sent_ns, 7);
    EXPECT_EQ(message->element.sequence, taken);
    for (const ContactRow& row : message->row) {
      EXPECT_EQ(row.value[11], 2e-5F);
      EXPECT_EQ(row.value[12], 0.0F);
    }
    if (message->element.active) {
      const auto i = static_cast<std::size_t>(message->contact);
      ++active[i];
      Eigen::Vector3d middle = Eigen::Vector3d::Zero();
      for (const ElementNode& node : message->element.node) {
        middle += Eigen::Map<const Eigen::Vector3d>(node.position_m.data()) / 3.0;
      }
      EXPECT_LT((middle - state.contact[i].position_m).head<2>().norm(), 0.005);
    }
    fifo->pop();
  }
  EXPECT_EQ(taken, sent);
  EXPECT_EQ(active, (std::array<int, 3>{1, 1, 1}));
}

TEST(ContactElements, AreSentWhenTheyChangeAndNowAndThen) {
  const ResponseDatabase database = padded_plate(3);
  ContactStream stream(database, tools(database, {"pads"}));
  const auto fifo = std::make_unique<ContactFifo>();
  ContactSent sent_so_far;
  ContactToolState state = at_height(stream.set(), 0.006);
  const auto drain = [&] {
    while (fifo->front() != nullptr) {
      fifo->pop();
    }
  };
  const std::size_t whole = stream.update(state, 0, *fifo, sent_so_far);
  drain();
  std::size_t again = 0;
  for (int i = 0; i < 3; ++i) {
    const std::size_t one = stream.update(state, 0, *fifo, sent_so_far);
    EXPECT_GT(one, 0U);
    again += one;
    drain();
  }
  EXPECT_EQ(again, whole);  // each contact once
  for (ToolState& contact : state.contact) {
    contact.position_m.x() += 0.01;
  }
  EXPECT_GE(stream.update(state, 0, *fifo, sent_so_far), whole);
  state.contact[1].position_m.x() = std::numeric_limits<double>::quiet_NaN();
  (void)stream.update(state, 0, *fifo, sent_so_far);
}

// A plate of three pads that comes down on the body, by both processes: each force is
// that of the equations with C = v / r.
TEST(ContactElements, RenderACoupledPress) {
  const ResponseDatabase database = padded_plate(3);
  ContactStream stream(database, tools(database, {"pads"}));
  FastConfig config;
  config.model = LocalModel::kPotential;
  CoupledStorage storage(stream.set(), config);
  const auto fifo = std::make_unique<ContactFifo>();
  ContactSent sent_so_far;
  PortPoses pose;
  WrenchCommand command;
  for (int tick = 0; tick < 2000; ++tick) {
    pose[0].position_m = {0.001, 0.002, 0.007 - 2.5e-6 * tick};
    if (tick % 20 == 0) {
      (void)stream.update(contact_tool_state(storage.state(), 1), 0, *fifo,
                          sent_so_far);
      while (const ContactElement* message = fifo->front()) {
        accept(storage.state(), *message);
        fifo->pop();
      }
    }
    command = step(storage.state(), {pose, 0}, 0.0005);
  }
  const double d = 0.005 - (0.007 - 2.5e-6 * 1999);
  const auto f = [&](double delta) {
    return database.tools[0].curve(0).at(delta).force_n;
  };
  double outer = d;
  double inner = d;
  for (int i = 0; i < 300; ++i) {
    outer = 0.5 * outer + 0.5 * (d - 2e-5 * (f(inner) / 0.012 + f(outer) / 0.024));
    inner = 0.5 * inner + 0.5 * (d - 2e-5 * 2.0 * f(outer) / 0.012);
  }
  EXPECT_EQ(command.fault, 0);
  EXPECT_EQ(command.contacts, 3);
  // Rows are floats: 2e-5F is off by 4e-8 of itself.
  EXPECT_NEAR(command.wrench[0].force_n.z(), 2.0 * f(outer) + f(inner), 4e-8);
  EXPECT_LT(command.wrench[0].force_n.z(), 0.9 * 3.0 * f(d));
  EXPECT_NEAR(contact_place(storage.state(), 1).force_n.z(), f(inner), 4e-8);
}

}  // namespace
}  // namespace palpate
