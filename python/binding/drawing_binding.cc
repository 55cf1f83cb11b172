// What a Python program draws of a renderer: contacts, and the displaced surface.
#include "python/binding/bind.h"
#include "python/binding/held_renderer.h"

#include <vector>

#include <pybind11/numpy.h>

namespace py = pybind11;

namespace palpate {
namespace {

template <typename T, typename Of>
py::array_t<T> contact_column(const std::vector<BodyContact>& contacts, Of of) {
  py::array_t<T> all(static_cast<py::ssize_t>(contacts.size()));
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    all.mutable_at(static_cast<py::ssize_t>(i)) = static_cast<T>(of(contacts[i]));
  }
  return all;
}

py::array_t<double> vectors(const std::vector<BodyContact>& contacts,
                            Vector3 ContactPlace::*member) {
  py::array_t<double> all({static_cast<py::ssize_t>(contacts.size()), py::ssize_t{3}});
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    Eigen::Map<Eigen::Vector3d>(all.mutable_data(static_cast<py::ssize_t>(i), 0)) =
        contacts[i].at.*member;
  }
  return all;
}

py::dict contacts_of(const HeldRenderer& renderer) {
  const std::vector<BodyContact> contacts = renderer.contacts();
  const auto at = [&]<typename T>(T ContactPlace::*member) {
    return contact_column<T>(contacts, [member](const BodyContact& contact) {
      return contact.at.*member;
    });
  };
  py::dict all;
  all["hand"] = contact_column<std::int32_t>(contacts, [](const BodyContact& contact) {
    return contact.hand;
  });
  all["touching"] = at(&ContactPlace::touching);
  all["triangle"] = at(&ContactPlace::triangle);
  all["radius_m"] = contact_column<double>(contacts, [](const BodyContact& contact) {
    return contact.radius_m;
  });
  all["centre_m"] = vectors(contacts, &ContactPlace::centre_m);
  all["point_m"] = vectors(contacts, &ContactPlace::point_m);
  all["normal"] = vectors(contacts, &ContactPlace::normal);
  all["force_n"] = vectors(contacts, &ContactPlace::force_n);
  all["depth_m"] = at(&ContactPlace::depth_m);
  all["own_depth_m"] = contact_column<double>(contacts, [](const BodyContact& contact) {
    return contact.at.depth_m - contact.at.dimple_m;
  });
  all["shares"] = vectors(contacts, &ContactPlace::share);
  return all;
}

py::object displaced_of(const HeldRenderer& renderer) {
  const DisplacedSurface surface = renderer.displaced();
  if (surface.known == 0) {
    return py::none();
  }
  return py::array_t<double>({surface.moved_m.rows(), Eigen::Index{3}},
                             surface.moved_m.data());
}

py::array_t<double> vertices_of(const HeldRenderer& renderer) {
  const SurfaceMesh* mesh = renderer.body().mesh();
  if (mesh == nullptr) {
    throw InputError("a streamed body has no vertices in memory: open it whole");
  }
  py::array_t<double> all({mesh->position_m.rows(), Eigen::Index{3}});
  for (Eigen::Index i = 0; i < mesh->position_m.rows(); ++i) {
    Eigen::Map<Eigen::Vector3d>(all.mutable_data(i, 0)) =
        renderer.body().placement().point_in_world(mesh->position_m.row(i).transpose());
  }
  return all;
}

}  // namespace

void bind_drawing(py::class_<HeldRenderer>& type) {
  type.def("contact_table", &contacts_of,
           "The contacts of the latest tick, as arrays of k rows: hand, touching, "
           "triangle, radius_m,\ncentre_m, point_m, normal, force_n, depth_m, "
           "own_depth_m (what its own force sinks the surface by), shares\n(of the "
           "point in its triangle). Points and forces are the world's (place()).");
  type.def("displaced", &displaced_of,
           "By how much the surface gives way now: (n, 3) [m] in the world, of the "
           "displacement fields\nthat the database stores; None: none is stored "
           "there. For drawing.");
  type.def_property_readonly("vertices", &vertices_of,
                             "(n, 3) [m] of the surface at rest, in the world");
}

}  // namespace palpate
