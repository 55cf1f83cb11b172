// Compliance of a scene's surface, for the capacitance matrix.
#pragma once

#include <filesystem>

namespace palpate::peers {

/// Of the contact nodes where the scene's tool may come, about a quarter of its radius
/// apart, by linear finite elements. Writes the number of these nodes (64 bit),
/// positions and outward normals (doubles, x y z of each in turn). Then follows the
/// matrix [m/N] (floats, symmetric): average inward displacement of one node for 1 N
/// spread over another.
/// @throws InputError, NumericalError.
void make_compliance(const std::filesystem::path& folder,
                     const std::filesystem::path& output);

}  // namespace palpate::peers
