#include "fitting/session/rigid_registration.h"

#include <algorithm>
#include <cmath>

#include <Eigen/SVD>
#include <fmt/format.h>

#include "formats/base/error.h"

namespace palpate {
namespace {

constexpr double kLine = 0.02;  // [-] of the extent: distances from a line
constexpr double kSizesApart = 0.2;
constexpr double kMirrorBetter = 0.5;  // [-] of the rotation's residuals
constexpr double kOutOfPlane = 3.0;    // times the mirror's residuals

using Cloud = Eigen::Matrix3Xd;

struct Centred {
  Eigen::Vector3d centre;
  Cloud points;  // about the centre
  Eigen::Matrix3d axes;
  Eigen::Vector3d extent;  // [m] rms along each axis, falling
};

Centred centred(const std::vector<RegistrationPair>& pairs,
                Eigen::Vector3d RegistrationPair::*place) {
  Centred cloud;
  cloud.points.resize(3, static_cast<Eigen::Index>(pairs.size()));
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    cloud.points.col(static_cast<Eigen::Index>(i)) = pairs[i].*place;
  }
  cloud.centre = cloud.points.rowwise().mean();
  cloud.points.colwise() -= cloud.centre;
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(cloud.points * cloud.points.transpose(),
                                              Eigen::ComputeFullU);
  cloud.axes = svd.matrixU();
  cloud.extent = (svd.singularValues() / static_cast<double>(pairs.size())).cwiseSqrt();
  return cloud;
}

void refuse_line(const Centred& cloud, const char* where) {
  if (!(std::hypot(cloud.extent[1], cloud.extent[2]) > kLine * cloud.extent[0])) {
    throw InputError(fmt::format(
        "the pairs lie on a line in the {} frame ({:.3g} m long, {:.3g} m wide): a "
        "turn "
        "about it stays unknown; add a pair away from it",
        where, cloud.extent[0], std::hypot(cloud.extent[1], cloud.extent[2])));
  }
}

void refuse_sizes(const Centred& machine, const Centred& mesh) {
  const double ratio = mesh.points.norm() / machine.points.norm();
  if (std::abs(std::log(ratio)) > std::log1p(kSizesApart)) {
    throw InputError(fmt::format(
        "distances between the pairs are {:.4g} times as long on the mesh as in the "
        "machine's frame: is length_unit that of both, and is each pair one point?",
        ratio));
  }
}

double rms_after(const Eigen::Matrix3d& R, const Centred& machine,
                 const Centred& mesh) {
  return (mesh.points - R * machine.points).norm() /
         std::sqrt(static_cast<double>(mesh.points.cols()));
}

void refuse_mirror(const Eigen::Matrix3d& rotation, const Eigen::Matrix3d& mirror,
                   const Centred& machine, const Centred& mesh) {
  const double turned = rms_after(rotation, machine, mesh);
  const double mirrored = rms_after(mirror, machine, mesh);
  const double out_of_plane = std::min(machine.extent[2], mesh.extent[2]);
  if (mirrored < kMirrorBetter * turned && out_of_plane > kOutOfPlane * mirrored) {
    throw InputError(fmt::format(
        "only a mirror brings the pairs together ({:.3g} m rms; a rotation leaves "
        "{:.3g} "
        "m): one frame is left-handed, an axis has the wrong sign or two are swapped",
        mirrored, turned));
  }
}

}  // namespace

Registration register_rigidly(std::vector<RegistrationPair> pairs) {
  if (pairs.size() < 3) {
    throw InputError(
        fmt::format("a registration has {} pairs, needs 3 or more that do "
                    "not lie on a line",
                    pairs.size()));
  }
  const Centred machine = centred(pairs, &RegistrationPair::machine_m);
  const Centred mesh = centred(pairs, &RegistrationPair::mesh_m);
  refuse_line(machine, "machine's");
  refuse_line(mesh, "mesh's");
  refuse_sizes(machine, mesh);
  // R = U diag(1, 1, +-1) V^T of sum mesh machine^T = U S V^T (Kabsch 1976), the sign
  // such that R is no mirror (Umeyama 1991).
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(
      mesh.points * machine.points.transpose(),
      Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d best = svd.matrixU() * svd.matrixV().transpose();
  Eigen::Matrix3d flipped = svd.matrixU();
  flipped.col(2) = -flipped.col(2);
  const Eigen::Matrix3d other = flipped * svd.matrixV().transpose();
  Registration r;
  r.rotation = best.determinant() > 0.0 ? best : other;
  if (best.determinant() < 0.0) {
    refuse_mirror(r.rotation, best, machine, mesh);
  }
  r.shift_m = mesh.centre - r.rotation * machine.centre;
  r.centre_m = mesh.centre;
  r.axes = mesh.axes;
  // Root mean square distance of the pairs from principal axis k.
  for (Eigen::Index k = 0; k < 3; ++k) {
    r.from_axes_m[k] = std::hypot(mesh.extent[(k + 1) % 3], mesh.extent[(k + 2) % 3]);
  }
  double squares = 0.0;
  for (const RegistrationPair& pair : pairs) {
    r.residual_m.push_back((pair.mesh_m - r.to_mesh_m(pair.machine_m)).norm());
    squares += r.residual_m.back() * r.residual_m.back();
  }
  const auto n = static_cast<double>(pairs.size());
  r.rms_m = std::sqrt(squares / n);
  // FRE^2 = (1 - 2 / n) FLE^2 (Fitzpatrick, West, Maurer 1998): FLE^2 = squares / (n -
  // 2).
  r.localisation_sd_m = std::sqrt(squares / (n - 2.0));
  r.pairs = std::move(pairs);
  return r;
}

double registration_error_m(const Registration& r, const Eigen::Vector3d& mesh_m) {
  // TRE^2 = FLE^2 / n (1 + 1/3 sum_k d_k^2 / f_k^2), d_k the place's distance from axis
  // k, f_k that of the pairs (Fitzpatrick, West, Maurer 1998).
  const Eigen::Vector3d p = r.axes.transpose() * (mesh_m - r.centre_m);
  double sum = 0.0;
  for (Eigen::Index k = 0; k < 3; ++k) {
    const double square = p.squaredNorm() - p[k] * p[k];
    sum += square / (r.from_axes_m[k] * r.from_axes_m[k]);
  }
  const auto n = static_cast<double>(r.pairs.size());
  return r.localisation_sd_m * std::sqrt((1.0 + sum / 3.0) / n);
}

}  // namespace palpate
