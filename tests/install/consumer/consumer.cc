// consumer DATABASE: opens and closes it by the installed library.
#include <cstdio>

#include <palpate.h>

int main(int argc, char** argv) {
  char error[256] = "usage: consumer DATABASE";
  palpate_body* body =
      argc == 2 ? palpate_open(argv[1], nullptr, error, sizeof error) : nullptr;
  if (body == nullptr || palpate_tool_add(body) == nullptr) {
    std::fprintf(stderr, "consumer: %s\n", error);
    return 1;
  }
  std::printf("abi %d\n", palpate_abi_version());
  palpate_close(body);
  return 0;
}
