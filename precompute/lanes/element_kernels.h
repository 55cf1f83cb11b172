// Quadratic tetrahedra, eight at a time: energy, nodal forces, stiffness.
//
// What fem/quadratic_element.h says of one element, for eight of one law side by side:
// numbers of the same kind stand together, [..][kBatch]. Bits are the same with every
// instruction set. Nothing here allocates, throws or reads what it was not given.
#pragma once

#include <cstddef>

namespace palpate {

enum class InstructionSet : int;

inline constexpr std::size_t kBatch = 8;  ///< elements of a batch
inline constexpr std::size_t kElementPoints = 4;
inline constexpr std::size_t kElementNodes = 10;
inline constexpr std::size_t kElementUnknowns = 30;  ///< 3 node + axis
/// 3 x 3 blocks (a, b), a >= b, in the order of a, then b; column by column inside.
inline constexpr std::size_t kElementBlocks = 55;

struct ElementBatch {
  double volume_m3[kBatch];
  /// Of the shape functions at the four points [1/m].
  double gradient[kElementPoints][kElementNodes][3][kBatch];
};

/// What an element averages over its points (VolumeMeasure).
enum class BatchVolume { kNone, kSmallTrace, kGreenTrace, kJacobian };

/// A law as numbers. The law's distortion has one of these kinds.
///
///   kInvariants: c10 (Ibar1 - 3) + c01 (Ibar2 - 3)
///   kGreenStrain: mu E:E + lambda/2 (tr E)^2
///   kSmallStrain: the same of the small strain
///   kOther: what the functions say, one point after the other.
struct BatchLaw {
  enum class Kind {
    kInvariants,
    kGreenStrain,
    kSmallStrain,
    kOther
  } kind = Kind::kOther;
  double c10_pa = 0.0, c01_pa = 0.0;
  double mu_pa = 0.0, lambda_pa = 0.0;
  BatchVolume volume = BatchVolume::kNone;
  double volume_modulus_pa = 0.0;
  const void* law = nullptr;
  /// Energy density [J/m^3] at F (9, column by column).
  double (*energy)(const void* law, const double* F) = nullptr;
  /// The same; sets stress (9) and tangent (81, dP_i/dF_j) [Pa].
  double (*response)(const void* law, const double* F, double* stress,
                     double* tangent) = nullptr;
};

/// What a batch answers; each number [kBatch].
struct BatchResponse {
  double energy_j[kBatch];  ///< +inf where the law does not admit the deformation
  double force_n[kElementUnknowns][kBatch];
  double stiffness[kElementBlocks][9][kBatch];  ///< [N/m]
};

struct ElementKernels {
  /// @param u_m (kElementUnknowns x kBatch). Sets energies [J], +inf where the law does
  /// not admit u, and the smallest det F [-] at the points.
  void (*energy)(const ElementBatch& batch, const BatchLaw& law, const double* u_m,
                 double* energy_j, double* smallest_jacobian);
  /// Energies, their first and second derivatives by u.
  void (*linearise)(const ElementBatch& batch, const BatchLaw& law, const double* u_m,
                    BatchResponse& response);
  /// Sets definite[i] to whether all eigenvalues of stiffness i are above -share times
  /// the mean of its diagonal.
  void (*is_definite)(const BatchResponse& response, double share, char* definite);
};

/// Of this processor's instruction set.
[[nodiscard]] const ElementKernels& element_kernels();
/// @param set must be one that the processor has: at most instruction_set().
[[nodiscard]] const ElementKernels& element_kernels(InstructionSet set);

}  // namespace palpate
