// Presses a body that stands turned in the world, and draws it as it gives way:
//   pressed_body DATABASE TOOL RADIUS_M > pressed.obj
#include <cmath>
#include <cstdio>
#include <exception>
#include <string>

#include <palpate.hpp>

int main(int argc, char** argv) try {
  if (argc != 4) {
    return 2;
  }
  palpate_options options = palpate::default_options();
  options.tool_name = argv[2];
  options.flags = PALPATE_OWN_SLOW_STEPS;
  palpate::Body body(argv[1], options);
  body.place({0.3, 0.0, 1.0}, {std::sin(0.2), 0.0, 0.0, std::cos(0.2)});  // by 0.4 rad
  palpate::Tool tool = body.add_tool();
  const palpate::Mesh mesh = body.mesh();  // in the world, as all that follows
  palpate::Point top = mesh.vertex.at(0);
  for (const palpate::Point& at : mesh.vertex) {
    top = at[2] > top[2] ? at : top;
  }
  palpate::Tick tick;
  for (int i = 0; i <= 1000; ++i) {  // one second: from 5 mm above to 3 mm inside
    const double height_m = std::stod(argv[3]) + 0.005 - 8e-6 * i;
    tick = tool.step({{top[0], top[1], top[2] + height_m}, {}}, 0.001);
    if (i % 10 == 0) {
      body.slow_step();
    }
  }
  std::printf("# %s, %g N upwards\n", tick.status_name(), tick.hand[0].force[2]);
  const auto moved = tool.displaced(tool.contacts());  // empty: no field is stored
  for (std::size_t i = 0; i < mesh.vertex.size(); ++i) {
    palpate::Point at = mesh.vertex[i];
    for (std::size_t k = 0; k < 3 && !moved.empty(); ++k) {
      at[k] += moved[i][k];
    }
    std::printf("v %g %g %g\n", at[0], at[1], at[2]);
  }
  for (const auto& t : mesh.corner) {
    std::printf("f %d %d %d\n", t[0] + 1, t[1] + 1, t[2] + 1);
  }
} catch (const std::exception& error) {
  std::fprintf(stderr, "pressed_body: %s\n", error.what());
  return 1;
}
