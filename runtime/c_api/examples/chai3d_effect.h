// A CHAI3D effect: object->addEffect(new PalpateEffect(object, "liver.h5", scale,
// 4000)).
//
// CHAI3D calls from its haptic thread, in the object's frame, with the id of one of up
// to 16 tools and without the time. How often it calls, its host says. A tool with
// workspace scale s makes the device feel s times the stiffness.
#pragma once

#include <stdexcept>

#include <palpate.h>

class PalpateEffect : public chai3d::cGenericEffect {
 public:
  PalpateEffect(chai3d::cGenericObject* object, const char* file, double scale,
                double haptic_hz = 1000.0)
      : cGenericEffect(object) {
    char error[256];
    palpate_options options{};
    options.struct_size = sizeof options;
    options.position_gain = scale;
    options.nominal_tick_s = 1.0 / haptic_hz;
    body_ = palpate_open(file, &options, error, sizeof error);
    if (body_ == nullptr) {
      throw std::runtime_error(error);
    }
    for (palpate_tool*& tool : tools_) {
      tool = palpate_tool_add(body_);  // here, not in the haptic thread
    }
  }
  ~PalpateEffect() override { palpate_close(body_); }

  bool computeForce(const chai3d::cVector3d& position, const chai3d::cVector3d&,
                    const unsigned int& id, chai3d::cVector3d& force) override {
    const double at[3] = {position.x(), position.y(), position.z()};
    double f[3] = {0.0, 0.0, 0.0};
    const int status =
        palpate_force(id < 16 ? tools_[id] : nullptr, at, nullptr, 0.0, f);
    force.set(f[0], f[1], f[2]);
    return status == PALPATE_CONTACT;
  }

 private:
  palpate_body* body_ = nullptr;
  palpate_tool* tools_[16] = {};
};
