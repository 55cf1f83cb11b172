// Linear capacitance matrix rendering after James and Pai (1999, 2001), written anew:
// the surface's compliance is known, vertices in the tool must move out of it, and a
// small dense system, the capacitance matrix of those in contact, gives their forces.
//
// Without friction: vertex i moves inwards along its normal by u = A f, f >= 0 are the
// vertices' forces along it, s the way out of the ball. u >= s, f (u - s) = 0: solved
// by principal pivoting from the last tick's contact. The compliance A is that of
// palpate's own linear finite elements (scene_compliance.h), the best there is for the
// comparison, on a surface about as fine as the tool's contact needs. The papers keep
// the inverse of the matrix up to date; here it is factorised anew, which costs more
// per step.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <stdexcept>
#include <vector>

#include <Eigen/Cholesky>
#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include "tests/peers/entrants/entrant.h"
#include "tests/peers/entrants/scene_values.h"

namespace peers {
namespace {

namespace fs = std::filesystem;

constexpr Eigen::Index kMostInBall = 512;
constexpr int kBlockExchanges = 8;  // then one at a time, which always ends
constexpr int kMostExchanges = 200;

// compliance.bin, mapped into memory: n, positions, normals (3 n doubles each), A (n^2
// floats, symmetric).
class MappedCompliance {
 public:
  explicit MappedCompliance(const fs::path& file) : bytes_(fs::file_size(file)) {
    const int handle = open(file.c_str(), O_RDONLY | O_CLOEXEC);
    void* begin =
        mmap(nullptr, bytes_, PROT_READ, MAP_PRIVATE | MAP_POPULATE, handle, 0);
    close(handle);
    if (begin == MAP_FAILED) {
      throw std::runtime_error("compliance.bin cannot be mapped");
    }
    begin_ = static_cast<const char*>(begin);
    count = static_cast<Eigen::Index>(*reinterpret_cast<const std::int64_t*>(begin_));
    position_m = reinterpret_cast<const double*>(begin_ + sizeof(std::int64_t));
    normal = position_m + 3 * count;
    m_per_n = reinterpret_cast<const float*>(normal + 3 * count);
  }
  ~MappedCompliance() { munmap(const_cast<char*>(begin_), bytes_); }
  MappedCompliance(const MappedCompliance&) = delete;
  MappedCompliance& operator=(const MappedCompliance&) = delete;

  Eigen::Index count = 0;
  const double* position_m = nullptr;
  const double* normal = nullptr;
  const float* m_per_n = nullptr;

 private:
  std::size_t bytes_;
  const char* begin_ = nullptr;
};

fs::path compliance_file(const fs::path& scene, const fs::path& own) {
  fs::path file = own / "compliance.bin";
  if (fs::exists(file)) {
    return file;
  }
  if (!fs::exists(scene / "body.toml")) {
    throw std::runtime_error("the scene has no material to compute a compliance of");
  }
  const std::string command = std::string(PALPATE_BIN_DIR) +
                              "/peers_scene compliance '" + scene.string() + "' -o '" +
                              file.string() + "' > /dev/null 2>&1";
  if (std::system(command.c_str()) != 0) {  // NOLINT(concurrency-mt-unsafe)
    throw std::runtime_error("this failed: " + command);
  }
  return file;
}

class Capacitance {
 public:
  static constexpr const char* kVariants[] = {"matrix", "matrix, conservative"};

  Capacitance(const fs::path& scene, const fs::path& own, const std::string& variant,
              double)
      : compliance_(std::make_unique<MappedCompliance>(compliance_file(scene, own))),
        conservative_(variant != "matrix"),
        radius_m_(SceneValues(scene).number("tool_radius_m")),
        in_contact_(static_cast<std::size_t>(compliance_->count), 0),
        matrix_(kMostInBall, kMostInBall),
        right_(kMostInBall) {
    ball_.reserve(kMostInBall);
    way_m_.reserve(kMostInBall);
    direction_.reserve(kMostInBall);
    free_.reserve(kMostInBall);
  }

  void pose(const Eigen::Vector3d& position_m) { centre_m_ = position_m; }

  Eigen::Vector3d force() {
    find_in_ball();
    solve();
    Eigen::Vector3d force_n = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < free_.size(); ++i) {
      force_n += right_[static_cast<Eigen::Index>(i)] * direction_[free_[i]];
    }
    return force_n;
  }

  void slow() {}

 private:
  using Vector = Eigen::Map<const Eigen::Vector3d>;
  [[nodiscard]] Vector position(Eigen::Index i) const {
    return Vector(compliance_->position_m + 3 * i);
  }
  [[nodiscard]] Vector normal(Eigen::Index i) const {
    return Vector(compliance_->normal + 3 * i);
  }
  [[nodiscard]] double entry(Eigen::Index i, Eigen::Index j) const {
    return static_cast<double>(compliance_->m_per_n[i * compliance_->count + j]);
  }

  // Vertices in the ball that face it, and their ways out of it along -normal: |r - s
  // n| = R. The textbook sums up the vertices' own forces, along their normals. The
  // other variant takes the derivative of the energy f . s / 2 instead: with m from the
  // centre to where a vertex leaves the ball, ds = -(m . dc) / (m . n).
  void find_in_ball() {
    ball_.clear();
    way_m_.clear();
    direction_.clear();
    const double square = radius_m_ * radius_m_;
    for (Eigen::Index i = 0; i < compliance_->count; ++i) {
      const Eigen::Vector3d r = position(i) - centre_m_;
      if (r.squaredNorm() >= square || ball_.size() >= kMostInBall) {
        in_contact_[static_cast<std::size_t>(i)] = 0;
        continue;
      }
      const double b = r.dot(normal(i));
      const double s = b + std::sqrt(b * b + square - r.squaredNorm());
      if (b < 0.0) {
        ball_.push_back(i);
        way_m_.push_back(s);
        const Eigen::Vector3d m = r - s * normal(i);
        direction_.emplace_back(conservative_ ? Eigen::Vector3d(m / m.dot(normal(i)))
                                              : Eigen::Vector3d(normal(i)));
      }
    }
  }

  // Forces of the vertices in contact, free_, in right_.
  void solve_contact() {
    free_.clear();
    for (std::size_t i = 0; i < ball_.size(); ++i) {
      if (in_contact_[static_cast<std::size_t>(ball_[i])] != 0) {
        free_.push_back(i);
      }
    }
    const auto n = static_cast<Eigen::Index>(free_.size());
    for (Eigen::Index i = 0; i < n; ++i) {
      const std::size_t at = free_[static_cast<std::size_t>(i)];
      right_[i] = way_m_[at];
      for (Eigen::Index j = 0; j <= i; ++j) {
        matrix_(i, j) = entry(ball_[at], ball_[free_[static_cast<std::size_t>(j)]]);
      }
    }
    Eigen::Ref<Eigen::MatrixXd> matrix = matrix_.topLeftCorner(n, n);
    const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factor(matrix);
    factor.solveInPlace(right_.head(n));
  }

  // Exchanges what pulls for what still reaches into the ball, until neither is there.
  void solve() {
    for (int exchange = 0; exchange < kMostExchanges; ++exchange) {
      solve_contact();
      const bool one = exchange >= kBlockExchanges;
      bool changed = false;
      for (std::size_t i = ball_.size(); i-- > 0 && !(one && changed);) {
        changed = exchanged(i) || changed;
      }
      if (!changed) {
        return;
      }
    }
  }

  bool exchanged(std::size_t i) {
    constexpr double kPullN = -1e-12;
    constexpr double kInM = 1e-12;
    char& contact = in_contact_[static_cast<std::size_t>(ball_[i])];
    if (contact != 0) {
      const auto at = std::lower_bound(free_.begin(), free_.end(), i) - free_.begin();
      contact = right_[at] < kPullN ? 0 : 1;
      return contact == 0;
    }
    double moved_m = 0.0;
    for (std::size_t j = 0; j < free_.size(); ++j) {
      moved_m +=
          entry(ball_[i], ball_[free_[j]]) * right_[static_cast<Eigen::Index>(j)];
    }
    contact = moved_m < way_m_[i] - kInM ? 1 : 0;
    return contact != 0;
  }

  std::unique_ptr<MappedCompliance> compliance_;
  bool conservative_;
  double radius_m_;
  Eigen::Vector3d centre_m_ = Eigen::Vector3d::Zero();
  std::vector<char> in_contact_;            // by vertex, kept from tick to tick
  std::vector<Eigen::Index> ball_;          // vertices in the ball, ascending
  std::vector<double> way_m_;               // of them
  std::vector<Eigen::Vector3d> direction_;  // of their forces on the ball
  std::vector<std::size_t> free_;           // of ball_: in contact, ascending
  Eigen::MatrixXd matrix_;
  Eigen::VectorXd right_;
};

}  // namespace
}  // namespace peers

PEERS_ENTRANT(peers::Capacitance)
