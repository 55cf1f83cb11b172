// A scene: the body, what is in it and what it is made of, and where it is held. A
// scene also states who presses the body and how far, and how exactly that is wanted.
#pragma once

#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "formats/response/tool_shape.h"

namespace palpate {

inline constexpr std::string_view kBodyRegion = "body";

struct SceneBall {
  Eigen::Vector3d center_m;  ///< [m]
  double radius_m = 0.0;     ///< [m] (0, inf)
};

/// A surface file: absolute, or relative to the working directory.
struct SceneMesh {
  std::filesystem::path file;
  std::string length_unit;  ///< known to metres_per
};

/// A part of the body of other material, or a hole. One of sphere, mesh and under_m is
/// given.
struct SceneInclusion {
  std::string name;  ///< unique, not "body"
  std::optional<SceneBall> sphere;
  std::optional<SceneMesh> mesh;
  bool cavity = false;
  /// [m] (0, inf) of a [[layer]]: all that lies so far or less under the body's
  /// surface, and in no layer above.
  std::optional<double> under_m = std::nullopt;
};

/// G(t) = 1 - sum g_k (1 - exp(-t / tau_k)) of all stresses; without terms 1.
struct SceneRelaxation {
  std::vector<double> g;      ///< [-] (0, 1), sum below 1; 1 to 4 terms
  std::vector<double> tau_s;  ///< [s] (0, inf) increasing; as many

  [[nodiscard]] bool operator==(const SceneRelaxation&) const = default;
};

/// Past yield_depth_m a share of the press stays as a dent.
struct ScenePlastic {
  double yield_depth_m = 0.0;  ///< [m] [0, inf)
  double share = 0.0;          ///< [-] [0, 1)
};

/// Past onset_m responses soften, by largest (1 - exp(-(m - onset) / scale)).
struct SceneDamage {
  double onset_m = 0.0;  ///< [m] [0, inf)
  double scale_m = 0.0;  ///< [m] (0, inf)
  double largest = 0.0;  ///< [-] [0, 1)
};

/// How responses yield for good (response/yielding.h).
struct SceneYielding {
  std::optional<ScenePlastic> plastic = {};
  std::optional<SceneDamage> damage = {};
};

/// How a needle gets through a material. Without it none does.
struct ScenePuncture {
  double toughness_j_per_m2 = 0.0;  ///< [J/m^2] [0, inf) of a needle's crack
  double static_ratio = 1.0;        ///< [-] [1, inf) static over kinetic friction
  // Friction of the shaft: [-] times radial stress, or per length; none: there is none.
  std::optional<double> friction = {};          ///< [-] [0, inf) coefficient, kinetic
  std::optional<double> radial_stress_pa = {};  ///< [Pa] [0, inf) on the shaft
  std::optional<double> friction_n_per_m = {};  ///< [N/m] [0, inf)
  // What breaks its boundary; none: the cutting force does.
  std::optional<double> membrane_n = {};  ///< [N] [0, inf)
  std::optional<double> membrane_j = {};  ///< [J] [0, inf)
};

/// A needle, pressed as a ball until it punctures.
struct SceneNeedle {
  double radius_m = 0.0;        ///< [m] (0, inf) of the shaft
  double tip_angle_rad = 0.0;   ///< [rad] (0, pi) full, of a cone; 0: a hemisphere
  double edge_width_m = 0.0;    ///< [m] (0, inf) width of the crack
  double press_radius_m = 0.0;  ///< [m] (0, inf) of the ball that is pressed
  double shaft_n_per_m = 0.0;   ///< [N/m] before the shaft slips; 0: by the material
  std::optional<double> lateral_n_per_m2 = {};  ///< [N/m^2]; none: by the material
  double mouth_m = 0.0;                         ///< [m] (0, inf)

  /// The ball that is pressed has the needle's own tip.
  [[nodiscard]] bool is_its_ball() const noexcept {
    return press_radius_m == radius_m && tip_angle_rad == 0.0;
  }
};

/// What a law does not have stays 0. Moduli are instantaneous ones.
struct SceneMaterial {
  std::string region = std::string(kBodyRegion);  ///< or the name of an inclusion
  /// linear, st-venant-kirchhoff, neo-hookean, mooney-rivlin, ogden or
  /// transversely-isotropic
  std::string law = "linear";
  double youngs_modulus_pa = 0.0;  ///< [Pa] (0, inf) linear, St. Venant, neo-Hookean;
                                   ///< across the fibre; of an exponential's matrix
  double poissons_ratio = 0.0;     ///< [-] (-1, 0.5); across a linear fibre (-1, 1)
  double c10_pa = 0.0;             ///< [Pa] [0, inf) Mooney-Rivlin; c10 + c01 > 0
  double c01_pa = 0.0;             ///< [Pa] [0, inf)
  std::vector<double> mu_pa;       ///< [Pa] Ogden, 1 to 4 terms
  std::vector<double> alpha;       ///< [-] as many; mu alpha > 0 in each
  Eigen::Vector3d fibre = Eigen::Vector3d::Zero();  ///< [-] unit
  std::string fibre_law;                            ///< linear or exponential
  double youngs_modulus_fibre_pa = 0.0;             ///< [Pa] (0, inf) E_l
  double shear_modulus_fibre_pa = 0.0;              ///< [Pa] (0, inf) G_lt
  double poissons_ratio_fibre = 0.0;  ///< [-] nu_lt: shrinks across when pulled along
  bool finite_strain = false;         ///< linear fibre: else small strain
  double k1_pa = 0.0;                 ///< [Pa] (0, inf) exponential fibre
  double k2 = 0.0;                    ///< [-] (0, inf)
  SceneRelaxation relaxation = {};
  SceneYielding yielding = {};  ///< of nodes under which it lies
  std::optional<ScenePuncture> puncture = {};
};

/// The side of a plane that its normal points away from.
struct ScenePlane {
  Eigen::Vector3d point_m;  ///< [m]
  Eigen::Vector3d normal;   ///< [-] unit
  /// [m] (0, inf] thickness of the layer that counts.
  double within_m = std::numeric_limits<double>::infinity();
};

/// Where the body is held: surface nodes inside one of box, plane, patch.
struct SceneSupport {
  std::optional<Eigen::AlignedBox3d> box_m;  ///< [m]
  std::optional<ScenePlane> plane;
  std::optional<SceneBall> patch;
  /// [Pa/m] [0, inf) 0: fixed; else an elastic foundation: springs per area, in all
  /// directions.
  double stiffness_pa_per_m = 0.0;

  [[nodiscard]] bool is_fixed() const { return stiffness_pa_per_m == 0.0; }
};

/// Whether a point of the surface is held. Points on the boundary are: of a plane to
/// 1e-9 of their distance from its point, so that a flat face lies on it.
[[nodiscard]] bool holds(const SceneSupport& support, const Eigen::Vector3d& p_m);

struct SceneReach {
  std::optional<Eigen::AlignedBox3d> box_m;  ///< [m]; none: every unsupported vertex
  double depth_max_m = 0.0;  ///< [m] (0, inf) largest normal penetration
  /// [N] (0, inf] curves end where they pass it; inf where the scene gives none.
  double force_max_n = std::numeric_limits<double>::infinity();
};

/// How exactly responses are wanted, and what may be done for it.
struct SceneAccuracy {
  int depths = 20;              ///< [-] [2, 64] samples of a curve after first touch
  std::string method = "auto";  ///< auto, linear or nonlinear
  std::string refine = "auto";  ///< auto, global or local refinement under the tool
  std::string solve = "auto";   ///< auto: interpolate where the budget allows; or all
  /// auto: of a nonlinear press some depths are solved, and the linear press corrected
  /// between them where the budget allows; or all.
  std::string solve_depths = "auto";
  /// [-] [0, 1000000] places solved better; the largest of 19 errors covers 95 %.
  int verify = 19;
  int bundles = 1;  ///< [-] [1, 8] parts of a relaxing curve
};

/// Every node is answered by a part of the body around it, cut out of the body's tets.
/// So the work of a node does not grow with the body.
struct SceneCutout {
  double radius_m = 0.0;            ///< [m] (0, inf) from the node to the cut
  std::string exterior = "coarse";  ///< what the cut stands on: coarse or clamped
  /// [m] (0, inf) edges of the coarse body that determines how far the cut deforms.
  double coarse_edge_m = 0.0;
};

/// Displacements of the surface for viewers, stored beside the responses.
struct SceneDrawing {
  bool displacement = false;
  double error_relative = 0.02;  ///< [-] (0, 1) of the largest displacement
};

struct Scene {
  std::filesystem::path mesh;  ///< absolute, or relative to the working directory
  std::string length_unit;     ///< of the mesh file, known to metres_per
  std::vector<SceneInclusion> inclusion;
  std::vector<SceneMaterial> material;  ///< one of every region that is no cavity
  std::vector<SceneSupport> support;
  /// A tool of kind "mesh" has no mesh yet: its file is at the same place of tool_mesh.
  std::vector<ToolShape> tool;
  std::vector<SceneMesh> tool_mesh;  ///< as many as tools; no file unless kind "mesh"
  /// As many: contacts of the tool couple with others (compliance_table.h).
  std::vector<bool> tool_couples;
  std::vector<SceneYielding> tool_yielding;  ///< as many; before the materials'
  std::vector<std::optional<SceneNeedle>> tool_needle;  ///< as many; none: no needle
  SceneReach reach;
  double force_relative = 0.05;  ///< [-] (0, 1) accuracy budget: relative force error
  /// [-] [0.5, 16] element sizes that the contact radius spans at the largest depth;
  /// 0: as many as force_relative needs.
  double contact_resolution = 0.0;
  SceneAccuracy accuracy;
  SceneDrawing drawing;
  std::optional<SceneCutout> cutout;  ///< none: every node is answered by all the body
  std::string text;                   ///< the file as read, for provenance
};

/// Reads and checks a scene file (TOML). Relative mesh paths are taken from the scene
/// file's folder. @throws InputError "scene.toml:12: ..." naming the key, its value and
/// what is allowed. For an unknown key the error names the nearest known one. For a key
/// that does not belong to a law or shape, the error names those that do.
[[nodiscard]] Scene read_scene(const std::filesystem::path& file);

}  // namespace palpate
