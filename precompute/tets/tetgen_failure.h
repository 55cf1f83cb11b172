// What TetGen's failure codes mean, and a failure path that does not kill the process.
#pragma once

#include <string>

namespace palpate {

/// The reason behind the code that TetGen throws, as the end of a sentence.
///
/// TetGen 1.5's terminatetetgen() frees the mesh and then throws, and unwinding frees
/// it again: the process dies before any catch. The source file beside this header
/// replaces that function for the whole program with one that throws only. It holds as
/// long as somebody calls tetgen_failure(), which draws the replacement out of the
/// archive.
[[nodiscard]] std::string tetgen_failure(int code);

}  // namespace palpate
