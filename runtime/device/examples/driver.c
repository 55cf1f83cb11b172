/* A driver for palpate in C99: a tool of 0.1 kg that a hand presses down and lifts again.
 *   driver SOCKET X Y Z      the place above the body to start from [m]
 * Put your device, your tracker or your simulation where it says "the device". */
#define _GNU_SOURCE
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <time.h>
#include <unistd.h>

struct hello { char magic[8]; double damping, coulomb, resolution, delay, force_max; };
struct state {
  int64_t time_ns;
  double position_m[3], withheld_n[3];
  uint64_t sequence;
  int64_t done_ns;
  uint64_t missed;
  double turn_wxyz[4]; /* not with "palpdev2", if yours does not know how it is turned */
};
struct command { uint64_t sequence; double force_n[3]; };

static int64_t now_ns(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (int64_t)t.tv_sec * 1000000000 + t.tv_nsec;
}

int main(int argc, char** argv) {
  if (argc != 5) { fprintf(stderr, "usage: driver SOCKET X Y Z\n"); return 2; }
  struct sockaddr_un address = {.sun_family = AF_UNIX};
  strncpy(address.sun_path, argv[1], sizeof address.sun_path - 1);
  int listener = socket(AF_UNIX, SOCK_SEQPACKET, 0);
  unlink(argv[1]);
  if (bind(listener, (struct sockaddr*)&address, sizeof address) || listen(listener, 1)) {
    perror(argv[1]); return 5;
  }
  int end = accept(listener, NULL, NULL);
  const struct hello hello = {"palpdev3", 0.5, 0.0, 0.0, 1e-3, 5.0};
  send(end, &hello, sizeof hello, MSG_NOSIGNAL);

  double x[3] = {atof(argv[2]), atof(argv[3]), atof(argv[4])}, v[3] = {0, 0, 0};
  const double start[3] = {x[0], x[1], x[2]}, h = 1e-3, mass = 0.1;
  struct command command = {0, {0, 0, 0}};
  struct timespec pause = {0, 1000000};
  double largest = 0.0;
  for (int64_t begin = now_ns(), heard = begin;; nanosleep(&pause, NULL)) {
    struct command next;
    ssize_t size;
    while ((size = recv(end, &next, sizeof next, MSG_DONTWAIT)) == (ssize_t)sizeof next) {
      command = next;
      heard = now_ns();
    }
    if (size >= 0) break;                                         /* its end is closed */
    if (now_ns() - heard > 20000000) memset(&command, 0, sizeof command); /* let go */
    struct state state = {.time_ns = now_ns(), .sequence = command.sequence};
    double hand_z = start[2] - 0.006 * (1.0 - cos(3.14 * (state.time_ns - begin) * 1e-9));
    for (int i = 0; i < 3; ++i) {                                        /* the device */
      double hand = i == 2 ? hand_z : start[i];
      v[i] += h / mass * (command.force_n[i] + 300.0 * (hand - x[i]) - 5.0 * v[i]);
      state.position_m[i] = x[i] += h * v[i];
    }
    double tilt = 0.05 * sin(2.0 * (state.time_ns - begin) * 1e-9);    /* half of it */
    state.turn_wxyz[0] = cos(tilt);
    state.turn_wxyz[1] = sin(tilt);                                      /* about x */
    largest = fmax(largest, fabs(command.force_n[2]));
    state.done_ns = now_ns();
    send(end, &state, sizeof state, MSG_DONTWAIT | MSG_NOSIGNAL);
  }
  printf("largest force %.3f N, last %.3f N\n", largest, fabs(command.force_n[2]));
  return 0;
}
