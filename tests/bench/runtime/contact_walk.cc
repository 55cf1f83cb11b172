#include "tests/bench/runtime/contact_walk.h"

#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

namespace palpate {
namespace {

constexpr int kTicksPerAim = 700;
constexpr std::size_t kKnots = 25;

}  // namespace

ContactBody make_contact_body(const BenchBodyOptions& options, double radius_m,
                              double thickness_m) {
  ContactBody made{.body = make_bench_body(options), .knots = {}, .row = {}};
  made.knots = {
      .first_m = 0.003, .log_step = std::log(40.0) / (kKnots - 1), .count = kKnots};
  const double amplitude =
      options.force_n / std::pow(options.depth_m, options.exponent);
  // Hertz: a = 4/3 E* sqrt(R).
  const double modulus_pa = 0.75 * amplitude / std::sqrt(radius_m);
  for (const Element& element : made.body.element) {
    for (const ElementNode& node : element.node) {
      const auto index = static_cast<std::size_t>(node.node);
      made.row.resize(std::max(made.row.size(), index + 1));
      const auto n = static_cast<std::size_t>(node.samples);
      const double stiffer = node.force_n[n - 1] / options.force_n;
      for (std::size_t k = 0; k < kKnots; ++k) {
        const double r =
            made.knots.first_m * std::exp(static_cast<double>(k) * made.knots.log_step);
        made.row[index].value[k] =
            static_cast<float>((1.0 - r / thickness_m) /
                               (std::numbers::pi * modulus_pa * std::sqrt(stiffer)));
      }
    }
  }
  return made;
}

void add_modes(ContactBody& body, double share) {
  body.modes = 2;
  for (const Element& element : body.body.element) {
    for (const ElementNode& node : element.node) {
      ContactRow& row = body.row[static_cast<std::size_t>(node.node)];
      const double amplitude =
          std::sqrt(share * static_cast<double>(row.value[0]) / 0.01);
      const double side = body.body.side_m();
      row.mode[0] = static_cast<float>(amplitude * (2.0 * node.position_m[0] / side));
      row.mode[1] = static_cast<float>(
          amplitude * std::sin(std::numbers::pi * node.position_m[1] / side));
    }
  }
}

CoupledSet make_plate(const ContactBody& body, int contacts, double apart_m,
                      double radius_m) {
  CoupledSet set;
  set.count = contacts;
  set.knots = body.knots;
  set.modes = body.modes;
  set.added_modes = body.modes / 2;
  const int side = static_cast<int>(std::ceil(std::sqrt(contacts)));
  for (int i = 0; i < contacts; ++i) {
    ContactSphere& sphere = set.sphere[static_cast<std::size_t>(i)];
    const int row = i / side;
    sphere.centre_m = {(i % side - 0.5 * (side - 1)) * apart_m,
                       (row - 0.5 * (side - 1)) * apart_m, 0.0};
    sphere.radius_m = radius_m;
  }
  (void)finish(set);
  return set;
}

CoupledSet make_pinch(const ContactBody& body, double radius_m) {
  CoupledSet set;
  set.count = 2;
  set.ports = 2;
  set.knots = body.knots;
  set.modes = body.modes;
  set.added_modes = body.modes / 2;
  for (std::size_t i = 0; i < 2; ++i) {
    set.sphere[i].radius_m = radius_m;
    set.sphere[i].port = static_cast<std::int8_t>(i);
  }
  (void)finish(set);
  return set;
}

void send(CoupledState& state, const ContactBody& body, const PortPoses& pose, int i) {
  ContactElement message;
  message.contact = i;
  for (const Element& element : body.body.around(centre_of(state.set, pose, i))) {
    message.element = element;
    for (std::size_t a = 0; a < 3; ++a) {
      message.row[a] = body.row[static_cast<std::size_t>(element.node[a].node)];
    }
    accept(state, message);
  }
}

PoseWalk::PoseWalk(const ContactBody& body, int ports, const PoseWalkOptions& options)
    : o_(options),
      ports_(ports),
      middle_(0.5 * body.body.side_m(), 0.5 * body.body.side_m(), 0.0),
      random_(options.seed) {
  for (int p = 0; p < ports; ++p) {
    Port& port = port_[static_cast<std::size_t>(p)];
    port.position = middle_ + Eigen::Vector3d((p - 0.5 * (ports - 1)) * o_.apart_m, 0.0,
                                              o_.radius_m + o_.lift_m);
  }
}

const PortPoses& PoseWalk::next() {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const bool aim = tick_++ % kTicksPerAim == 0;
  for (int p = 0; p < ports_; ++p) {
    Port& port = port_[static_cast<std::size_t>(p)];
    if (aim) {
      const double height = 0.5 * (o_.lift_m - o_.depth_m) +
                            0.5 * (o_.lift_m + o_.depth_m) * unit(random_);
      port.aim = middle_ +
                 Eigen::Vector3d(
                     (p - 0.5 * (ports_ - 1)) * o_.apart_m + o_.reach_m * unit(random_),
                     o_.reach_m * unit(random_), o_.radius_m + height);
      port.turn_aim = {o_.tilt_rad * unit(random_), o_.tilt_rad * unit(random_),
                       o_.turn_rad * unit(random_)};
    }
    port.velocity +=
        ((port.aim - port.position) * 60.0 - 12.0 * port.velocity) * kTickS;
    port.position += kTickS * port.velocity;
    port.turning += ((port.turn_aim - port.turn) * 60.0 - 12.0 * port.turning) * kTickS;
    port.turn += kTickS * port.turning;
    PortPose& pose = pose_[static_cast<std::size_t>(p)];
    pose.position_m = port.position;
    pose.rotation = (Eigen::AngleAxisd(port.turn.x(), Eigen::Vector3d::UnitX()) *
                     Eigen::AngleAxisd(port.turn.y(), Eigen::Vector3d::UnitY()) *
                     Eigen::AngleAxisd(port.turn.z(), Eigen::Vector3d::UnitZ()))
                        .toRotationMatrix();
  }
  return pose_;
}

}  // namespace palpate
