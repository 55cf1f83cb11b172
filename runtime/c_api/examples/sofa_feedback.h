// A SOFA force feedback: what a device driver's thread asks for a force.
//
// SOFA gives position and quaternion of the tool, often 0 0 0 0, and lengths in the
// unit of its scene. SOFA gives no time (its driver's rate). SOFA takes no torque:
// palpate_force() turns a tool of several contacts at no gain for the hand.
#pragma once

#include <stdexcept>
#include <string>

#include <palpate.h>

class PalpateForceFeedback : public sofa::component::controller::ForceFeedback {
 public:
  PalpateForceFeedback(std::string file, double metres_per_unit,
                       double haptic_hz = 1000.0)
      : file_(std::move(file)),
        metres_per_unit_(metres_per_unit),
        haptic_hz_(haptic_hz) {}
  ~PalpateForceFeedback() override { palpate_close(body_); }

  void init() override {
    char error[256];
    palpate_options options{};
    options.struct_size = sizeof options;
    options.metres_per_unit = metres_per_unit_;
    options.nominal_tick_s = 1.0 / haptic_hz_;
    body_ = palpate_open(file_.c_str(), &options, error, sizeof error);
    if (body_ == nullptr) {
      throw std::runtime_error(error);
    }
    tool_ = palpate_tool_add(body_);
  }

  void computeForce(double x, double y, double z, double u, double v, double w,
                    double q, double& fx, double& fy, double& fz) override {
    const double position[3] = {x, y, z};
    const double quaternion[4] = {u, v, w, q};
    double force[3] = {0.0, 0.0, 0.0};
    palpate_force(tool_, position, quaternion, 0.0, force);
    fx = force[0];
    fy = force[1];
    fz = force[2];
  }

 private:
  std::string file_;
  double metres_per_unit_;
  double haptic_hz_;
  palpate_body* body_ = nullptr;
  palpate_tool* tool_ = nullptr;
};
