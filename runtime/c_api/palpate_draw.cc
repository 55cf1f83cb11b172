// The C interface's displaced surface.
#include "runtime/c_api/palpate_draw.h"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <vector>

#include "formats/base/error.h"
#include "runtime/c_api/guarded.h"
#include "runtime/c_api/host_drawing.h"
#include "runtime/c_api/host_handles.h"

namespace {

// What counts for displacements. @param from contact_bytes of a palpate_contact
palpate::BodyContact given_contact(const palpate_tool& tool, const unsigned char* from,
                                   size_t contact_bytes) {
  palpate_contact given{};
  std::memcpy(&given, from, std::min(contact_bytes, sizeof given));
  palpate::BodyContact contact;
  contact.hand = given.hand;
  contact.table = given.table;
  contact.at.touching = given.touching != 0;
  contact.at.triangle = given.triangle;
  contact.at.depth_m = given.own_depth * tool.metres_per_unit;
  contact.at.share = Eigen::Vector3d(given.shares);
  return contact;
}

}  // namespace

int palpate_displaced(const palpate_tool* tool, const palpate_contact* contacts,
                      size_t count, size_t contact_bytes, double* displacements,
                      char* error, size_t error_bytes) {
  palpate::copy_text("", error, error_bytes);
  return palpate::guarded(error, error_bytes, [&] {
    if (tool == nullptr || displacements == nullptr ||
        (count > 0 && contacts == nullptr) || contact_bytes < sizeof(size_t)) {
      throw palpate::InputError(
          "no tool, contacts or displacements: a pointer is null");
    }
    std::vector<palpate::BodyContact> all;
    for (size_t i = 0; i < count; ++i) {
      all.push_back(given_contact(
          *tool, reinterpret_cast<const unsigned char*>(contacts) + i * contact_bytes,
          contact_bytes));
    }
    const palpate::DisplacedSurface surface =
        palpate::displaced_surface(tool->body, tool->tool, all);
    Eigen::Map<palpate::Points>(displacements, surface.moved_m.rows(), 3) =
        surface.moved_m / tool->metres_per_unit;
    return surface.known;
  });
}
