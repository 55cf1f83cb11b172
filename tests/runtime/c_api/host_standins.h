// What the examples need of CHAI3D and SOFA: the shapes of their interfaces, no more.
#pragma once

namespace chai3d {

class cVector3d {
 public:
  [[nodiscard]] double x() const { return v_[0]; }
  [[nodiscard]] double y() const { return v_[1]; }
  [[nodiscard]] double z() const { return v_[2]; }
  void set(double x, double y, double z) {
    v_[0] = x;
    v_[1] = y;
    v_[2] = z;
  }

 private:
  double v_[3] = {0.0, 0.0, 0.0};
};

class cGenericObject {};

class cGenericEffect {
 public:
  explicit cGenericEffect(cGenericObject* /*parent*/) {}
  virtual ~cGenericEffect() = default;
  virtual bool computeForce(const cVector3d& position, const cVector3d& velocity,
                            const unsigned int& id, cVector3d& force) = 0;
};

}  // namespace chai3d

namespace sofa::component::controller {

class ForceFeedback {
 public:
  virtual ~ForceFeedback() = default;
  virtual void init() = 0;
  virtual void computeForce(double x, double y, double z, double u, double v, double w,
                            double q, double& fx, double& fy, double& fz) = 0;
};

}  // namespace sofa::component::controller
