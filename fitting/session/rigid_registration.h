// Where a mesh lies in a machine's frame, from points known in both.
//
//   y_i = R x_i + t + error      R a rotation, t a shift
//
// Symbols: x_i a point in the machine's frame [m], y_i the same on the mesh [m]. R and
// t of least squares by singular values (Kabsch 1976; Umeyama 1991).
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

namespace palpate {

struct RegistrationPair {
  std::string name;
  Eigen::Vector3d machine_m, mesh_m;
};

struct Registration {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d shift_m = Eigen::Vector3d::Zero();
  std::vector<RegistrationPair> pairs;
  std::vector<double> residual_m;  ///< (n) [m] distance left at each pair
  double rms_m = 0.0;              ///< [m] of those: the fiducial registration error
  double localisation_sd_m = 0.0;
  ///< [m] rms error of a pair's position, sqrt(sum of squares / (n - 2))

  // Of the pairs on the mesh: centre, unit axes (columns), rms distances from them.
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  Eigen::Vector3d from_axes_m = Eigen::Vector3d::Ones();

  [[nodiscard]] Eigen::Vector3d to_mesh_m(const Eigen::Vector3d& machine_m) const {
    return rotation * machine_m + shift_m;
  }
};

/// @throws InputError for fewer than 3 pairs, and pairs on a line (rms distance from it
/// less than 2 % of their extent). InputError too for sizes of the two clouds that
/// differ by more than a fifth, and pairs that only a mirror brings together.
[[nodiscard]] Registration register_rigidly(std::vector<RegistrationPair> pairs);

/// Expected rms error [m] of a point of the mesh, from the pairs' own errors alone:
/// localisation_sd^2 / n (1 + sum_k d_k^2 / (3 f_k^2)). d_k is the point's distance
/// from axis k, f_k the pairs' rms distance (Fitzpatrick, West and Maurer 1998).
[[nodiscard]] double registration_error_m(const Registration& registration,
                                          const Eigen::Vector3d& mesh_m);

}  // namespace palpate
