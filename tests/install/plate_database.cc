// plate_database FILE: the plate that an installed library presses; f = 2e4 d^2.
#include "tests/support/sample_bodies.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    return 2;
  }
  const palpate::NodeForce force = [](Eigen::Index /*node*/, double d) {
    return 2e4 * d * d;
  };
  palpate::write_database(
      argv[1], palpate::sample_database(palpate::plate(0.1, 10),
                                        palpate::ball(0.005, 0.3, 5e-4), force, 0.01));
  return 0;
}
